//! The state of one import, and the stream of tokens that its parts read from.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::rc::Rc;

use octray_geometry::Solid;

use super::directives::Flow;
use super::lexer::{Kind, Tape, Token, Words};
use super::lower::Lowering;
use super::scene::Collected;
use super::scope::Scopes;
use super::texture::Texture;
use super::value::Value;
use crate::{Diagnostic, Diagnostics, FileSystem, Options, Severity, SourceId, Span};

/// An error has been reported: whoever can, goes on behind the statement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reported;

pub(super) type Parsed<T> = Result<T, Reported>;

/// A source or a macro body being read.
pub(super) struct Frame {
    pub(super) tape: Tape,
    pub(super) at: usize,
    pub(super) end: usize,
    /// How many scopes there were before it.
    pub(super) scopes: usize,
    /// How many `#if`, `#while`, ... were open before it.
    pub(super) flow: usize,
}

/// How deep statements, expressions, includes and macros may be nested, all together.
const MAX_DEPTH: usize = 150;

/// How many files and macros may be open at once.
const MAX_FRAMES: usize = 400;

/// How many errors end the reading.
const MAX_ERRORS: usize = 50;

/// Reads a scene: an interpreter, since the language is a program that makes objects.
pub(super) struct Reader<'a> {
    pub(super) diagnostics: Diagnostics,
    pub(super) files: &'a dyn FileSystem,
    /// The folder of the scene.
    pub(super) folder: PathBuf,
    pub(super) frames: Vec<Frame>,
    pub(super) flow: Vec<Flow>,
    pub(super) scopes: Scopes,
    pub(super) words: Words,
    ahead: Option<Token>,
    /// Where the look-ahead begins in its frame.
    pub(super) ahead_at: usize,
    /// Inside the value of a `#declare`, where the next directive of its own frame ends the
    /// value: how many frames there are; otherwise 0.
    pub(super) hold: usize,
    /// The next name is not expanded even if it is a macro.
    pub(super) raw_names: bool,
    depth: usize,
    pub(super) braces: usize,
    pub(super) steps: u64,
    max_steps: u64,
    bytes: u64,
    pub(super) max_bytes: u64,
    halted: bool,
    errors: usize,
    reported: BTreeSet<(u32, usize, String)>,
    pub(super) last: Span,
    /// The last token taken was a sign that something must follow.
    pub(super) after_operator: bool,
    /// The language version in force.
    pub(super) version: f64,
    pub(super) default_texture: Rc<Texture>,
    pub(super) random: Vec<u32>,
    /// A standard include that is not known in full was asked for.
    pub(super) partial_includes: bool,
    /// `image_width` or `image_height` was read.
    pub(super) read_image_size: bool,
    pub(super) scene: Collected,
    pub(super) lowering: Lowering,
    /// Balls by the bits of their radius.
    pub(super) spheres: BTreeMap<u64, Solid>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(
        diagnostics: Diagnostics,
        files: &'a dyn FileSystem,
        options: &'a Options,
        folder: PathBuf,
    ) -> Self {
        let max_bytes = options.memory_budget;
        Self {
            diagnostics,
            files,
            folder,
            frames: Vec::new(),
            flow: Vec::new(),
            scopes: Scopes::new(),
            words: Words::default(),
            ahead: None,
            ahead_at: 0,
            hold: 0,
            raw_names: false,
            depth: 0,
            braces: 0,
            steps: 0,
            max_steps: (max_bytes / 64).clamp(10_000, 100_000_000),
            bytes: 0,
            max_bytes,
            halted: false,
            errors: 0,
            reported: BTreeSet::new(),
            last: Span::new(SourceId(0), 0..0),
            after_operator: false,
            version: 3.62,
            default_texture: Rc::new(Texture::default()),
            random: Vec::new(),
            partial_includes: false,
            read_image_size: false,
            scene: Collected::default(),
            lowering: Lowering::default(),
            spheres: BTreeMap::new(),
        }
    }

    fn report(&mut self, severity: Severity, span: Span, message: String, help: Option<String>) {
        // A loop would say the same thing about the same place each time round.
        let key = (span.source.0, span.start, message);
        if self.reported.contains(&key) {
            return;
        }
        self.diagnostics.push(Diagnostic {
            severity,
            span: Some(span),
            message: key.2.clone(),
            help,
        });
        self.reported.insert(key);
        if severity == Severity::Error {
            self.errors += 1;
            self.halted |= self.errors >= MAX_ERRORS;
        }
    }

    pub(super) fn warn(&mut self, span: Span, message: impl Into<String>) {
        self.report(Severity::Warning, span, message.into(), None);
    }

    pub(super) fn fail<T>(&mut self, span: Span, message: impl Into<String>) -> Parsed<T> {
        self.fail_with_help(span, message, None)
    }

    pub(super) fn fail_with_help<T>(
        &mut self,
        span: Span,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Parsed<T> {
        if !self.halted {
            self.report(Severity::Error, span, message.into(), help);
        }
        Err(Reported)
    }

    /// Reports an error after which nothing more is read.
    pub(super) fn halt<T>(&mut self, span: Span, message: impl Into<String>) -> Parsed<T> {
        let result = self.fail(span, message);
        self.halted = true;
        self.ahead = None;
        result
    }

    /// Books memory that what is read will take.
    pub(super) fn book(&mut self, bytes: u64) -> Parsed<()> {
        self.bytes = self.bytes.saturating_add(bytes);
        if self.bytes > self.max_bytes {
            let limit = self.max_bytes >> 20;
            return self.halt(self.last, format!("the scene needs more than {limit} MiB"));
        }
        Ok(())
    }

    /// Runs `f` one level deeper; refuses where that would be too deep for the stack.
    pub(super) fn nested<T>(&mut self, f: impl FnOnce(&mut Self) -> Parsed<T>) -> Parsed<T> {
        if self.depth >= MAX_DEPTH {
            return self.halt(
                self.last,
                format!("this is nested more than {MAX_DEPTH} deep"),
            );
        }
        self.depth += 1;
        let result = f(self);
        self.depth -= 1;
        result
    }

    /// Starts to read tokens that end at `end` before going on with the present ones.
    pub(super) fn push_frame(
        &mut self,
        tape: Tape,
        at: usize,
        end: usize,
        scopes: usize,
    ) -> Parsed<()> {
        if self.frames.len() >= MAX_FRAMES {
            return self.halt(
                self.last,
                format!("files and macros are nested more than {MAX_FRAMES} deep"),
            );
        }
        self.frames.push(Frame {
            tape,
            at,
            end,
            scopes,
            flow: self.flow.len(),
        });
        Ok(())
    }

    /// The next token as it stands, directives and macro names included; `None` at the very end.
    pub(super) fn raw(&mut self) -> Option<Token> {
        loop {
            if self.halted {
                return None;
            }
            self.steps += 1;
            if self.steps > self.max_steps {
                let message = format!(
                    "reading stopped after {} steps: a loop or a macro seems never to end",
                    self.max_steps
                );
                let _ = self.halt::<()>(self.last, message);
                return None;
            }
            let frame = self.frames.last_mut()?;
            if frame.at < frame.end {
                let (token, next) = frame.tape.token(frame.at, &mut self.words);
                if token.kind != Kind::End {
                    self.ahead_at = frame.at;
                    frame.at = next;
                    self.last = token.span;
                    return Some(token);
                }
            }
            self.pop_frame();
        }
    }

    fn pop_frame(&mut self) {
        let Some(frame) = self.frames.pop() else {
            return;
        };
        if self.flow.len() > frame.flow {
            let span = self.flow[frame.flow].span;
            let _ = self.fail::<()>(span, "this has no `#end`");
            self.flow.truncate(frame.flow);
        }
        self.scopes.truncate(frame.scopes);
    }

    /// Fills the look-ahead: runs directives and expands macros on the way.
    fn fill(&mut self) {
        while self.ahead.is_none() {
            let Some(token) = self.raw() else {
                self.ahead = Some(Token {
                    kind: Kind::End,
                    span: self.last,
                });
                return;
            };
            match &token.kind {
                Kind::Directive(name) => {
                    if self.hold == self.frames.len() && self.ends_value(name) {
                        self.ahead = Some(token);
                        return;
                    }
                    let name = Rc::clone(name);
                    let ran = self.nested(|r| r.directive(&name, token.span));
                    if ran.is_err() {
                        self.skip_remains(";");
                    }
                }
                Kind::Bad(what) => {
                    let what = *what;
                    let _ = self.fail::<()>(token.span, format!("here is {what}"));
                }
                Kind::Word(name) if !self.raw_names => {
                    if let Some(Value::Macro(found)) = self.scopes.get(name) {
                        let (found, name) = (Rc::clone(found), Rc::clone(name));
                        let called = self.nested(|r| r.call_macro(&name, &found, token.span));
                        if called.is_err() {
                            self.skip_remains(")");
                        }
                    } else {
                        self.ahead = Some(token);
                    }
                }
                _ => self.ahead = Some(token),
            }
        }
    }

    /// Drops what a directive or macro call that went wrong has left: up to the sign that ends it,
    /// or to where something else begins.
    fn skip_remains(&mut self, last: &str) {
        self.ahead = None;
        let Some(frame) = self.frames.last_mut() else {
            return;
        };
        while frame.at < frame.end {
            let (token, next) = frame.tape.token(frame.at, &mut self.words);
            match &token.kind {
                Kind::Sign(sign) if *sign == last => {
                    frame.at = next;
                    return;
                }
                Kind::Directive(_) | Kind::End | Kind::Sign("}") => return,
                Kind::Word(word) if super::STATEMENTS.contains(&&**word) => return,
                _ => frame.at = next,
            }
        }
    }

    /// The next token, left in place.
    pub(super) fn look(&mut self) -> &Token {
        if self.ahead.is_none() {
            self.fill();
        }
        let span = self.last;
        self.ahead.get_or_insert(Token {
            kind: Kind::End,
            span,
        })
    }

    /// A copy of the next token.
    pub(super) fn peek(&mut self) -> Token {
        self.look().clone()
    }

    /// Takes the next token.
    pub(super) fn next(&mut self) -> Token {
        let is_end = self.look().kind == Kind::End;
        let span = self.last;
        let kind = Kind::End;
        let token = match self.ahead.take() {
            Some(token) if !is_end => token,
            _ => self.ahead.insert(Token { kind, span }).clone(),
        };
        match token.kind {
            Kind::Sign("{") => self.braces += 1,
            Kind::Sign("}") => self.braces = self.braces.saturating_sub(1),
            _ => {}
        }
        self.last = token.span;
        self.after_operator = match token.kind {
            Kind::Sign(sign) => !matches!(sign, ")" | "]" | "}" | ">"),
            _ => false,
        };
        token
    }

    /// Runs `f` so that it does not run a directive that follows what it reads: the `#end` of a
    /// loop must not jump before the value before it is stored.
    pub(super) fn held<T>(&mut self, f: impl FnOnce(&mut Self) -> Parsed<T>) -> Parsed<T> {
        let before = std::mem::replace(&mut self.hold, self.frames.len());
        let result = f(self);
        self.hold = before;
        self.release_held_directive();
        result
    }

    /// Drops a look-ahead directive and steps back to before it, so that it runs next.
    fn release_held_directive(&mut self) {
        if let Some(Token {
            kind: Kind::Directive(_),
            ..
        }) = self.ahead
        {
            self.ahead = None;
            if let Some(frame) = self.frames.last_mut() {
                frame.at = self.ahead_at;
            }
        }
    }

    /// Moves the reading position of the present frame; forgets the look-ahead.
    pub(super) fn jump(&mut self, at: usize) {
        self.ahead = None;
        if let Some(frame) = self.frames.last_mut() {
            frame.at = at;
        }
    }

    /// What stands behind the look-ahead, directives and macro names included.
    pub(super) fn behind_next(&mut self) -> Option<Token> {
        self.look();
        let frame = self.frames.last()?;
        Some(frame.tape.token(frame.at, &mut self.words).0)
    }

    /// The numbers of a vector whose opening bracket was taken, if they are plain, with their
    /// closing bracket.
    pub(super) fn plain_vector(&mut self, out: &mut [f64; 5]) -> Option<usize> {
        if self.ahead.is_some() || self.halted {
            return None;
        }
        let frame = self.frames.last_mut()?;
        let (count, bracket) = frame.tape.plain_vector(frame.at, out)?;
        if bracket >= frame.end {
            return None;
        }
        frame.at = bracket;
        self.steps += count as u64;
        Some(count)
    }

    /// Exchanges the look-ahead: function bodies are read from a place of their own.
    pub(super) const fn swap_look_ahead(&mut self, ahead: Option<Token>) -> Option<Token> {
        std::mem::replace(&mut self.ahead, ahead)
    }
}
