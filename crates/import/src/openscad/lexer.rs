//! The words of a dump.

use logos::Logos;

/// The kind of a token; its text is found through its range.
#[derive(Clone, Copy, Debug, Logos, PartialEq, Eq)]
#[logos(skip r"[ \t\r\n\x0c\u{feff}]+")]
#[logos(skip("//[^\n]*", allow_greedy = true))]
pub(super) enum Token {
    /// A name or one of the words `true`, `false`, `undef`, `inf`, `nan`.
    #[regex(r"[$]?[A-Za-z_][A-Za-z0-9_]*")]
    Word,
    /// Digits with a fraction and an exponent, without a sign.
    #[regex(r"([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")]
    Number,
    /// A string with its quotes and escapes.
    #[regex(r#""([^"\\]|\\[\s\S])*""#)]
    Text,
    /// A string that the file ends in.
    #[regex(r#""([^"\\]|\\[\s\S])*\\?"#)]
    OpenText,
    /// `(`
    #[token("(")]
    OpenParen,
    /// `)`
    #[token(")")]
    CloseParen,
    /// `[`
    #[token("[")]
    OpenBracket,
    /// `]`
    #[token("]")]
    CloseBracket,
    /// `{`
    #[token("{")]
    OpenBrace,
    /// `}`
    #[token("}")]
    CloseBrace,
    /// `,`
    #[token(",")]
    Comma,
    /// `;`
    #[token(";")]
    Semicolon,
    /// `=`
    #[token("=")]
    Equals,
    /// `-`
    #[token("-")]
    Minus,
    /// `+`
    #[token("+")]
    Plus,
    /// `%`: not part of the model, shown for orientation.
    #[token("%")]
    Background,
    /// `#`: part of the model, shown conspicuously.
    #[token("#")]
    Highlight,
    /// `*`: left out.
    #[token("*")]
    Disable,
    /// `!`: everything else is left out.
    #[token("!")]
    Root,
    /// A comment over lines; never handed out.
    #[token("/*", skip_block_comment)]
    Comment,
    /// Characters that mean nothing here.
    #[regex(r"[^\s\w$.()\[\]{},;=+%#*!/\x22-]+", priority = 0)]
    Unknown,
}

/// A token and where it is, 12 bytes: dumps have millions of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lexeme {
    pub(super) token: Token,
    pub(super) start: u32,
    pub(super) end: u32,
}

/// Moves past the end of the comment; `false` if there is none.
fn skip_block_comment(lexer: &mut logos::Lexer<'_, Token>) -> bool {
    let rest = lexer.remainder();
    let end = rest.find("*/");
    lexer.bump(end.map_or(rest.len(), |at| at + 2));
    end.is_some()
}

/// Splits a text of less than 4 GiB into tokens.
///
/// What is no token comes out as [`Token::Unknown`], a comment without end as one such token.
pub(super) fn tokens(text: &str) -> Vec<Lexeme> {
    let mut lexer = Token::lexer(text);
    let mut all = Vec::new();
    while let Some(token) = lexer.next() {
        let token = match token {
            Ok(Token::Comment) => continue,
            Ok(token) => token,
            Err(()) => Token::Unknown,
        };
        let range = lexer.span();
        all.push(Lexeme {
            token,
            start: range.start as u32,
            end: range.end as u32,
        });
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> Vec<Token> {
        tokens(text).iter().map(|lexeme| lexeme.token).collect()
    }

    #[test]
    fn comments_and_blanks_vanish() {
        assert_eq!(
            kinds("a // b\n/* c ** / */ $d /**/ ;"),
            [Token::Word, Token::Word, Token::Semicolon]
        );
    }

    #[test]
    fn numbers_take_their_exponent() {
        assert_eq!(kinds("1e+06 .5 5. 1.25e-7"), [Token::Number; 4]);
        assert_eq!(kinds("1e"), [Token::Number, Token::Word]);
    }

    #[test]
    fn strings_may_hold_quotes_and_lines() {
        assert_eq!(kinds("\"a\\\"b\nc\\\\\" x"), [Token::Text, Token::Word]);
        assert_eq!(kinds("\"a;\\"), [Token::OpenText]);
        assert_eq!(kinds("\""), [Token::OpenText]);
    }

    #[test]
    fn what_is_no_token_is_kept_as_unknown() {
        assert_eq!(kinds("☠ /* open"), [Token::Unknown, Token::Unknown]);
        assert_eq!(kinds("a & b").len(), 3);
    }
}
