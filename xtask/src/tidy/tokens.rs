//! Words and punctuation of Rust code: the tokens that rules about names and functions read.

/// A word, a `::` or another character of code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    /// Its text, without the `r#` of a raw name.
    pub text: &'a str,
    /// Line from 1.
    pub line: usize,
}

impl Token<'_> {
    /// Whether it is a name, a keyword or a number.
    pub fn is_word(&self) -> bool {
        self.text.starts_with(is_word)
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Tokens of code without comments and strings; lifetimes are left out.
pub fn tokens(code: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    let (mut line, mut at) = (1, 0);
    while let Some(c) = code[at..].chars().next() {
        let rest = &code[at..];
        let word = |text: &str| text.find(|c| !is_word(c)).unwrap_or(text.len());
        let length = if let Some(raw) = rest.strip_prefix("r#").filter(|raw| raw.starts_with(is_word)) {
            let end = word(raw);
            found.push(Token { text: &raw[..end], line });
            2 + end
        } else if is_word(c) {
            let end = word(rest);
            found.push(Token { text: &rest[..end], line });
            end
        } else if c == '\'' {
            1 + word(&rest[1..])
        } else if rest.starts_with("::") {
            found.push(Token { text: &rest[..2], line });
            2
        } else {
            if !c.is_whitespace() {
                found.push(Token { text: &rest[..c.len_utf8()], line });
            }
            line += usize::from(c == '\n');
            c.len_utf8()
        };
        at += length;
    }
    found
}

/// Position behind the bracket that closes the one at `open`; the end where none does.
pub fn behind_bracket(tokens: &[Token<'_>], open: usize) -> usize {
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate().skip(open) {
        match token.text {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => {
                depth -= 1;
                if depth == 0 {
                    return i + 1;
                }
            }
            _ => {}
        }
    }
    tokens.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_is_cut_into_words_and_punctuation() {
        let found = tokens("fn f<'a>(x: &'a r#type::B)\n{ 1.5 }");
        let texts: Vec<&str> = found.iter().map(|token| token.text).collect();
        let expected = ["fn", "f", "<", ">", "(", "x", ":", "&", "type", "::", "B", ")", "{", "1", ".", "5", "}"];
        assert_eq!(texts, expected);
        assert_eq!(found[12], Token { text: "{", line: 2 });
        assert!(found[0].is_word() && !found[2].is_word());
    }

    #[test]
    fn brackets_are_closed() {
        let found = tokens("a ( b [ c ] ) d (");
        assert_eq!(behind_bracket(&found, 1), 7);
        assert_eq!(behind_bracket(&found, 8), found.len());
    }
}
