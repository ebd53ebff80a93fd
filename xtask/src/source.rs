//! Rust source without what is not code: enough of a lexer for rules about words.

use std::ops::Range;

/// The text with the contents of comments, strings and character literals replaced by blanks; line breaks stay.
pub fn code(text: &str) -> String {
    blanked(text, false)
}

/// Blanks comments, and literals unless they are kept.
fn blanked(text: &str, keeps_literals: bool) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut out = String::with_capacity(text.len());
    let mut i = 0;
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let blank = |out: &mut String, from: usize, to: usize| {
        for &c in &chars[from..to.min(chars.len())] {
            out.push(if c == '\n' { '\n' } else { ' ' });
        }
    };
    while i < chars.len() {
        let is_comment = at(i) == '/';
        let end = match (at(i), at(i + 1)) {
            ('/', '/') => (i..chars.len()).find(|&j| at(j) == '\n').unwrap_or(chars.len()),
            ('/', '*') => block_comment_end(&chars, i),
            ('"', _) => string_end(&chars, i),
            ('r' | 'b' | 'c', _) if i == 0 || !is_word(at(i - 1)) => match raw_string_end(&chars, i) {
                Some(end) => end,
                None => i,
            },
            ('\'', _) => character_end(&chars, i),
            _ => i,
        };
        if end > i {
            if keeps_literals && !is_comment {
                out.extend(&chars[i..end.min(chars.len())]);
            } else {
                blank(&mut out, i, end);
            }
            i = end;
        } else {
            out.push(at(i));
            i += 1;
        }
    }
    out
}

fn block_comment_end(chars: &[char], start: usize) -> usize {
    let mut depth = 0;
    let mut i = start;
    while i < chars.len() {
        match (chars[i], chars.get(i + 1)) {
            ('/', Some('*')) => {
                depth += 1;
                i += 2;
            }
            ('*', Some('/')) => {
                depth -= 1;
                i += 2;
                if depth == 0 {
                    return i;
                }
            }
            _ => i += 1,
        }
    }
    chars.len()
}

fn string_end(chars: &[char], start: usize) -> usize {
    let mut i = start + 1;
    while i < chars.len() {
        match chars[i] {
            '\\' => i += 2,
            '"' => return i + 1,
            _ => i += 1,
        }
    }
    chars.len()
}

/// End of a raw string, if one (`r"…"`, `br#"…"#`) starts here.
fn raw_string_end(chars: &[char], start: usize) -> Option<usize> {
    let mut i = start;
    if matches!(chars[i], 'b' | 'c') {
        i += 1;
    }
    if chars.get(i) != Some(&'r') {
        return None;
    }
    i += 1;
    let hashes = chars[i..].iter().take_while(|&&c| c == '#').count();
    i += hashes;
    if chars.get(i) != Some(&'"') {
        return None;
    }
    let closes = |j: usize| {
        chars[j] == '"' && chars.get(j + 1..j + 1 + hashes).is_some_and(|tail| tail.iter().all(|&c| c == '#'))
    };
    Some((i + 1..chars.len()).find(|&j| closes(j)).map_or(chars.len(), |j| j + 1 + hashes))
}

/// End of a character literal that starts here; the start itself for a lifetime.
fn character_end(chars: &[char], start: usize) -> usize {
    match (chars.get(start + 1), chars.get(start + 2)) {
        (Some('\\'), _) => (start + 3..chars.len()).find(|&j| chars[j] == '\'').map_or(start, |j| j + 1),
        (Some(_), Some('\'')) => start + 3,
        _ => start,
    }
}

/// Code (as [`code`] returns it) without `#[cfg(test)]` modules; line breaks stay.
pub fn without_tests(code: &str) -> String {
    let mut out = String::with_capacity(code.len());
    let mut from = 0;
    for Range { start, end } in test_ranges(code) {
        out.push_str(&code[from..start]);
        out.extend(code[start..end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
        from = end;
    }
    out.push_str(&code[from..]);
    out
}

/// Where `#[cfg(test)]` modules and imports stand in code.
fn test_ranges(code: &str) -> Vec<Range<usize>> {
    const MARK: &str = "#[cfg(test)]";
    let mut ranges = Vec::new();
    let mut from = 0;
    while let Some(start) = code[from..].find(MARK).map(|found| from + found) {
        let body = &code[start + MARK.len()..];
        let open = body.find('{');
        let stop = body.find(';');
        let length = match (open, stop) {
            (Some(open), stop) if stop.is_none_or(|stop| open < stop) => closing_brace(body, open),
            (_, Some(stop)) => stop + 1,
            _ => body.len(),
        };
        from = start + MARK.len() + length;
        ranges.push(start..from);
    }
    ranges
}

/// For each line, whether it is a product line: outside test modules, neither blank nor comment alone.
///
/// This is what the workspace means by lines of a file, a function or a crate.
pub fn product_lines(text: &str) -> Vec<bool> {
    let code = code(text);
    let line_of = |at: usize| code[..at].matches('\n').count();
    let tests: Vec<Range<usize>> =
        test_ranges(&code).into_iter().map(|range| line_of(range.start)..line_of(range.end) + 1).collect();
    let is_test = |line: &usize| tests.iter().any(|range| range.contains(line));
    let lines = blanked(text, true);
    lines.lines().enumerate().map(|(line, text)| !text.trim().is_empty() && !is_test(&line)).collect()
}

fn closing_brace(body: &str, open: usize) -> usize {
    let mut depth = 0;
    for (i, c) in body[open..].char_indices() {
        match c {
            '{' => depth += 1,
            '}' => {
                depth -= 1;
                if depth == 0 {
                    return open + i + 1;
                }
            }
            _ => {}
        }
    }
    body.len()
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Lines (from 1) on which the words occur: bounded by what is no part of a word wherever they start or end with a letter.
pub fn lines_with(text: &str, words: &str) -> Vec<usize> {
    let first = words.chars().next().is_some_and(is_word);
    let last = words.chars().next_back().is_some_and(is_word);
    let mut lines = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let found = line.match_indices(words).any(|(at, _)| {
            let before = line[..at].chars().next_back();
            let after = line[at + words.len()..].chars().next();
            !(first && before.is_some_and(is_word) || last && after.is_some_and(is_word))
        });
        if found {
            lines.push(number);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_strings_and_characters_are_blanked() {
        let check = |text: &str, expected: &str| assert_eq!(code(text).trim_end(), expected, "{text}");
        check("a // b", "a");
        check("a /* b /* c */ d */ e", "a                   e");
        check("f(\"b\\\"c\") + 1", "f(      ) + 1");
        check("f(r#\"b\"c\"#) + 1", "f(        ) + 1");
        check("x('a', '\\'', b'b')", "x(   ,     , b   )");
        check("fn f<'a>(x: &'a str)", "fn f<'a>(x: &'a str)");
        check("for x", "for x");
        check("'\"' y", "    y");
        assert_eq!(code("a\n// b\n/* \n */c").lines().count(), 4);
    }

    #[test]
    fn test_modules_are_cut_out() {
        let cut = without_tests("a();\n#[cfg(test)]\nmod tests { fn x() { b() } }\nc();");
        assert!(cut.contains("a()") && cut.contains("c()") && !cut.contains('b'));
        assert_eq!(cut.lines().count(), 4);
        assert!(!without_tests("#[cfg(test)]\nmod b;\nc();").contains('b'));
    }

    #[test]
    fn product_lines_are_no_comments_blanks_or_tests() {
        let text = "//! Doc.\n\nfn f() { // says\n    \"a\n    b // c\"\n}\n/* d\n e */\n#[cfg(test)]\nmod tests {\n    x\n}\ng();";
        let counted: Vec<usize> = (1..).zip(product_lines(text)).filter(|(_, is)| *is).map(|(line, _)| line).collect();
        assert_eq!(counted, [3, 4, 5, 6, 13]);
    }

    #[test]
    fn words_are_found_whole() {
        assert_eq!(lines_with("unsafe_code\nx unsafe {", "unsafe"), [2]);
        assert_eq!(lines_with("println!\neprintln!", "println!"), [1]);
        assert_eq!(lines_with("std::fs::read\nstd::fsx", "std::fs"), [1]);
    }
}
