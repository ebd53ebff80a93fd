//! Text as HTML: escaped, in tables, and put into a template.

pub use sinew_formats::xml_text::escaped;
use std::fmt::Write as _;

/// Text whose words between backquotes are code.
pub fn with_code(text: &str) -> String {
    let parts: Vec<&str> = text.split('`').collect();
    let is_code = |index: usize| index % 2 == 1 && index + 1 < parts.len();
    let part = |(index, part): (usize, &&str)| match is_code(index) {
        true => format!("<code>{}</code>", escaped(part)),
        false if index % 2 == 1 => format!("`{}", escaped(part)),
        false => escaped(part),
    };
    parts.iter().enumerate().map(part).collect()
}

/// A table of cells that are HTML; the first of a row heads it.
pub fn table(caption: &str, heads: &[&str], rows: &[Vec<String>]) -> String {
    let mut out = format!("<div class=\"wide\"><table><caption>{caption}</caption>\n");
    if !heads.is_empty() {
        out.push_str("<thead><tr>");
        out.extend(heads.iter().map(|head| format!("<th scope=\"col\">{head}</th>")));
        out.push_str("</tr></thead>\n");
    }
    out.push_str("<tbody>\n");
    for row in rows {
        out.push_str("<tr>");
        for (index, cell) in row.iter().enumerate() {
            let _ = match index {
                0 => write!(out, "<th scope=\"row\">{cell}</th>"),
                _ => write!(out, "<td>{cell}</td>"),
            };
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table></div>\n");
    out
}

/// A template with each `{{name}}` in it replaced by the part of that name; what parts hold is left as it is.
pub fn filled(template: &str, parts: &[(&str, String)]) -> String {
    let mut pieces = template.split("{{");
    let mut out = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (name, rest) = piece.split_once("}}").unwrap_or((piece, ""));
        if let Some((_, part)) = parts.iter().find(|(known, _)| *known == name) {
            out.push_str(part);
        }
        out.push_str(rest);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_no_harm() {
        let name = "</script><b>\"'&";
        assert_eq!(escaped(name), "&lt;/script&gt;&lt;b&gt;&quot;&#39;&amp;");
        assert_eq!(with_code("give `--fps <b>` or ` &"), "give <code>--fps &lt;b&gt;</code> or ` &amp;");
        let parts = [("a", "{{b}}".to_owned()), ("b", "x".to_owned())];
        assert_eq!(filled("1{{a}}2{{b}}3{{c}}4", &parts), "1{{b}}2x34");
    }
}
