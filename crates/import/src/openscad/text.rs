//! Strings as OpenSCAD writes them.

/// The string that the escapes of a literal (without its quotes) stand for.
///
/// `\n`, `\t`, `\r`, `\"`, `\\`, `\xHH`, `\uHHHH` and `\UHHHHHH` as in OpenSCAD's manual; other
/// escapes stay as they are.
pub(super) fn unescape(literal: &str) -> String {
    let mut text = String::with_capacity(literal.len());
    let mut rest = literal;
    while let Some(at) = rest.find('\\') {
        text.push_str(&rest[..at]);
        let escape = &rest[at + 1..];
        let Some(letter) = escape.chars().next() else {
            text.push('\\');
            return text;
        };
        let digits = match letter {
            'x' => 2,
            'u' => 4,
            'U' => 6,
            _ => 0,
        };
        let coded = escape
            .get(1..=digits)
            .filter(|hex| digits > 0 && hex.bytes().all(|b| b.is_ascii_hexdigit()))
            .and_then(|hex| u32::from_str_radix(hex, 16).ok())
            .and_then(char::from_u32);
        let plain = match letter {
            'n' => Some('\n'),
            't' => Some('\t'),
            'r' => Some('\r'),
            '"' | '\\' => Some(letter),
            _ => None,
        };
        let length = if coded.is_some() { digits } else { 0 };
        match coded.or(plain) {
            Some(character) => text.push(character),
            None => text.extend(['\\', letter]),
        }
        rest = &escape[letter.len_utf8() + length..];
    }
    text.push_str(rest);
    text
}

#[cfg(test)]
mod tests {
    use super::unescape;

    #[test]
    fn escapes_stand_for_characters() {
        assert_eq!(unescape(r#"a\"b\\c\td\ne"#), "a\"b\\c\td\ne");
        assert_eq!(unescape(r"\x41\u2620\U01F600"), "A\u{2620}\u{1F600}");
    }

    #[test]
    fn broken_escapes_stay() {
        assert_eq!(unescape(r"\q \x4 \uD800 \"), r"\q \x4 \uD800 \");
        assert_eq!(unescape("\\\u{2620}"), "\\\u{2620}");
    }
}
