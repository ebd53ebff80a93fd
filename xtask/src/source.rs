//! Rust source as tokens with their lines: without comments, literals and, where wanted, test modules.

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

/// A word, a sign or a bracket.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    /// Its text; `::` is one.
    pub text: String,
    /// Line from 1.
    pub line: usize,
}

/// Tokens one after the other.
pub fn flat(stream: TokenStream) -> Vec<Token> {
    let mut tokens = Vec::new();
    flatten(stream, &mut tokens);
    tokens
}

fn flatten(stream: TokenStream, tokens: &mut Vec<Token>) {
    let push = |text: &str, line: usize, tokens: &mut Vec<Token>| match tokens.last_mut() {
        Some(last) if text == ":" && last.text == ":" && last.line == line => last.text = "::".into(),
        _ => tokens.push(Token { text: text.into(), line }),
    };
    for tree in stream {
        let line = tree.span().start().line;
        match tree {
            TokenTree::Group(group) => {
                let [open, close] = match group.delimiter() {
                    Delimiter::Parenthesis => ["(", ")"],
                    Delimiter::Bracket => ["[", "]"],
                    Delimiter::Brace => ["{", "}"],
                    Delimiter::None => ["", ""],
                };
                push(open, line, tokens);
                flatten(group.stream(), tokens);
                push(close, group.span_close().start().line, tokens);
            }
            TokenTree::Literal(_) => push("\"\"", line, tokens),
            other => push(&other.to_string(), line, tokens),
        }
    }
}

/// Literals as they are written, but for comments of items.
pub fn literals(stream: TokenStream) -> Vec<Token> {
    let mut found = Vec::new();
    for tree in stream {
        match tree {
            TokenTree::Group(group) if !is_comment(&group) => found.extend(literals(group.stream())),
            TokenTree::Literal(literal) => {
                found.push(Token { text: literal.to_string(), line: literal.span().start().line });
            }
            _ => {}
        }
    }
    found
}

fn is_comment(group: &Group) -> bool {
    let first = group.stream().into_iter().next();
    group.delimiter() == Delimiter::Bracket && first.is_some_and(|first| first.to_string() == "doc")
}

/// What does not stand under `#[cfg(test)]`.
pub fn without_tests(stream: TokenStream) -> TokenStream {
    let mut kept: Vec<TokenTree> = Vec::new();
    let mut is_test = false;
    for tree in stream {
        let is_end = match &tree {
            TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
            TokenTree::Punct(sign) => sign.as_char() == ';',
            _ => false,
        };
        match tree {
            _ if is_test => is_test = !is_end,
            TokenTree::Group(group) if is_test_mark(&group) => {
                kept.pop();
                is_test = true;
            }
            TokenTree::Group(group) => {
                let mut inside = Group::new(group.delimiter(), without_tests(group.stream()));
                inside.set_span(group.span());
                kept.push(inside.into());
            }
            other => kept.push(other),
        }
    }
    kept.into_iter().collect()
}

fn is_test_mark(group: &Group) -> bool {
    group.delimiter() == Delimiter::Bracket && group.stream().to_string().replace(' ', "") == "cfg(test)"
}

/// Lines on which a sequence of tokens begins, which are written with blanks between: `std :: fs`.
pub fn lines_with(tokens: &[Token], sequence: &str) -> Vec<usize> {
    let wanted: Vec<&str> = sequence.split_whitespace().collect();
    let begins = |at: &[Token]| at.iter().map(|token| token.text.as_str()).eq(wanted.iter().copied());
    let mut lines: Vec<usize> =
        tokens.windows(wanted.len()).filter(|window| begins(window)).map(|window| window[0].line).collect();
    lines.dedup();
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<String> {
        flat(text.parse().unwrap()).into_iter().map(|token| token.text).collect()
    }

    #[test]
    fn comments_and_contents_of_literals_are_no_tokens() {
        assert_eq!(texts("a /* b */ :: c(\"d\", 'e') // f\n"), ["a", "::", "c", "(", "\"\"", ",", "\"\"", ")"]);
    }

    #[test]
    fn comments_are_no_literals() {
        let found = literals("/// a\n#[error(\"b\")]\nfn f() { g(['c', \"d\"]) }".parse().unwrap());
        let found: Vec<(&str, usize)> = found.iter().map(|token| (token.text.as_str(), token.line)).collect();
        assert_eq!(found, [("\"b\"", 2), ("'c'", 3), ("\"d\"", 3)]);
    }

    #[test]
    fn test_modules_are_left_out() {
        let text = "a();\n#[cfg(test)]\nmod tests { fn x() { b() } }\nmod m { #[cfg(test)] mod d; c(); }";
        let kept = flat(without_tests(text.parse().unwrap()));
        assert!(kept.iter().all(|token| !["b", "d", "tests"].contains(&token.text.as_str())));
        assert_eq!((lines_with(&kept, "a ( )"), lines_with(&kept, "c (")), (vec![1], vec![4]));
    }

    #[test]
    fn sequences_are_found_whole() {
        let tokens = flat("unsafe_code\nx unsafe {}\nstd::fs::read; std::fsx".parse().unwrap());
        assert_eq!(lines_with(&tokens, "unsafe"), [2]);
        assert_eq!(lines_with(&tokens, "std :: fs"), [3]);
    }
}
