//! Rust source without what is not code: enough of a lexer for rules about words.

/// The text with the contents of comments, strings and character literals replaced by blanks; line breaks stay.
pub fn code(text: &str) -> String {
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
            blank(&mut out, i, end);
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
    const MARK: &str = "#[cfg(test)]";
    let mut out = String::with_capacity(code.len());
    let mut rest = code;
    while let Some(start) = rest.find(MARK) {
        let (before, tail) = rest.split_at(start);
        out.push_str(before);
        let body = &tail[MARK.len()..];
        let open = body.find('{');
        let stop = body.find(';');
        let length = match (open, stop) {
            (Some(open), stop) if stop.is_none_or(|stop| open < stop) => closing_brace(body, open),
            (_, Some(stop)) => stop + 1,
            _ => body.len(),
        };
        out.extend(tail[..MARK.len() + length].chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
        rest = &body[length..];
    }
    out.push_str(rest);
    out
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
    fn words_are_found_whole() {
        assert_eq!(lines_with("unsafe_code\nx unsafe {", "unsafe"), [2]);
        assert_eq!(lines_with("println!\neprintln!", "println!"), [1]);
        assert_eq!(lines_with("std::fs::read\nstd::fsx", "std::fs"), [1]);
    }
}
