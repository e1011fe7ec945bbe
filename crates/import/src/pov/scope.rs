//! Identifiers and where they are visible.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::value::Value;

/// The tables of identifiers: the global one, then one for each file and macro being read.
///
/// A name is looked up from the innermost table outwards through all of them, as POV-Ray does:
/// a macro sees the local names of whoever called it.
#[derive(Debug)]
pub(super) struct Scopes {
    tables: Vec<Table>,
}

#[derive(Debug, Default)]
struct Table {
    values: BTreeMap<Rc<str>, Value>,
    /// Parameters that were given as a plain name, and that name: to declare the one is to
    /// declare the other.
    outer_names: BTreeMap<Rc<str>, Rc<str>>,
}

impl Scopes {
    pub(super) fn new() -> Self {
        Self {
            tables: vec![Table::default()],
        }
    }

    pub(super) fn depth(&self) -> usize {
        self.tables.len()
    }

    pub(super) fn open(&mut self) {
        self.tables.push(Table::default());
    }

    pub(super) fn truncate(&mut self, depth: usize) {
        self.tables.truncate(depth.max(1));
    }

    pub(super) fn get(&self, name: &str) -> Option<&Value> {
        let mut tables = self.tables.iter().rev();
        tables.find_map(|table| table.values.get(name))
    }

    pub(super) fn get_mut(&mut self, name: &str) -> Option<&mut Value> {
        let mut tables = self.tables.iter_mut().rev();
        tables.find_map(|table| table.values.get_mut(name))
    }

    /// `#declare`: a name that is visible keeps its table, a new one is global.
    pub(super) fn declare(&mut self, name: Rc<str>, value: Value) {
        self.declare_below(self.tables.len(), name, value);
    }

    fn declare_below(&mut self, mut below: usize, mut name: Rc<str>, value: Value) {
        loop {
            let visible = |table: &Table| {
                table.values.contains_key(&name) || table.outer_names.contains_key(&name)
            };
            let Some(index) = self.tables[..below].iter().rposition(visible) else {
                self.tables[0].values.insert(name, value);
                return;
            };
            let table = &mut self.tables[index];
            table.values.insert(Rc::clone(&name), value.clone());
            match table.outer_names.get(&name) {
                Some(outer) if index > 0 => (below, name) = (index, Rc::clone(outer)),
                _ => return,
            }
        }
    }

    /// `#local`.
    pub(super) fn local(&mut self, name: Rc<str>, value: Value) {
        if let Some(table) = self.tables.last_mut() {
            table.values.insert(name, value);
        }
    }

    /// Binds a parameter of the macro whose table was opened last to a name of its caller.
    pub(super) fn bind(&mut self, parameter: Rc<str>, outer: Rc<str>) {
        if let Some(table) = self.tables.last_mut() {
            table.outer_names.insert(parameter, outer);
        }
    }

    /// `#undef`.
    pub(super) fn remove(&mut self, name: &str) {
        for table in self.tables.iter_mut().rev() {
            if table.values.remove(name).is_some() {
                return;
            }
        }
    }

    /// Visible names, for suggestions.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.tables
            .iter()
            .flat_map(|table| table.values.keys().map(|name| &**name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pov::value::Terms;

    fn number(scopes: &Scopes, name: &str) -> f64 {
        match scopes.get(name) {
            Some(Value::Terms(terms)) => terms.v[0],
            other => panic!("{name}: {other:?}"),
        }
    }

    #[test]
    fn a_declared_parameter_changes_the_name_that_was_given_for_it() {
        let value = |x: f64| Value::Terms(Terms::number(x));
        let mut scopes = Scopes::new();
        scopes.declare("A".into(), value(1.0));
        scopes.open();
        scopes.local("P".into(), value(1.0));
        scopes.bind("P".into(), "A".into());
        scopes.declare("P".into(), value(2.0));
        scopes.local("A".into(), value(7.0));
        assert_eq!((number(&scopes, "P"), number(&scopes, "A")), (2.0, 7.0));
        scopes.truncate(1);
        assert_eq!(number(&scopes, "A"), 2.0);
        assert!(scopes.get("P").is_none());
    }
}
