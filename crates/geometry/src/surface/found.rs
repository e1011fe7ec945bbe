//! Parameters at which a line crosses a closed surface, in any order and number.

/// More than this are kept on the heap.
const INLINE: usize = 12;

/// See the module.
#[derive(Debug)]
pub(super) struct Found {
    count: usize,
    inline: [f64; INLINE],
    spilled: Vec<f64>,
}

impl Found {
    pub(super) const fn new() -> Self {
        Self {
            count: 0,
            inline: [0.0; INLINE],
            spilled: Vec::new(),
        }
    }

    pub(super) fn push(&mut self, t: f64) {
        if self.count < INLINE {
            self.inline[self.count] = t;
        } else {
            if self.count == INLINE {
                self.spilled.extend(self.inline);
            }
            self.spilled.push(t);
        }
        self.count += 1;
    }

    /// Visits them in order; pairs that are equal vanish.
    pub(super) fn visit_sorted(mut self, visit: &mut impl FnMut(f64)) {
        let all = if self.count > INLINE {
            &mut self.spilled[..]
        } else {
            &mut self.inline[..self.count]
        };
        all.sort_unstable_by(f64::total_cmp);
        let mut waiting: Option<f64> = None;
        for &t in all.iter() {
            waiting = match waiting {
                Some(before) if before == t => None,
                Some(before) => {
                    visit(before);
                    Some(t)
                }
                None => Some(t),
            };
        }
        if let Some(last) = waiting {
            visit(last);
        }
    }
}
