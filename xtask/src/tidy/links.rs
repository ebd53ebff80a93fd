//! Markdown pages: every link and path leads somewhere, every page is listed.

use super::workspace::Violation;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

/// Page that lists the pages under `docs`.
const INDEX: &str = "docs/README.md";

/// Pages by their path from the root.
type Pages = BTreeMap<String, String>;

/// What does not hold on the pages of the workspace.
///
/// # Errors
/// Of reading them.
pub fn check(root: &Path) -> io::Result<Vec<Violation>> {
    let mut pages = Pages::new();
    for folder in ["", "docs", "crates", "xtask", "tests", "fuzz"] {
        read(root, folder, folder.is_empty(), &mut pages)?;
    }
    let mut found: Vec<Violation> =
        pages.keys().flat_map(|path| page(path, &pages, &|to| root.join(to).exists())).collect();
    found.extend(unlisted(&pages));
    Ok(found)
}

fn read(root: &Path, folder: &str, flat: bool, pages: &mut Pages) -> io::Result<()> {
    for entry in fs::read_dir(root.join(folder))? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = if folder.is_empty() { name.clone() } else { format!("{folder}/{name}") };
        if entry.file_type()?.is_dir() {
            if !flat && name != "target" {
                read(root, &path, false, pages)?;
            }
        } else if name.ends_with(".md") {
            pages.insert(path, fs::read_to_string(entry.path())?);
        }
    }
    Ok(())
}

/// Pages under `docs` that the index does not link.
fn unlisted(pages: &Pages) -> Vec<Violation> {
    let linked: Vec<String> = pages
        .get(INDEX)
        .map(|text| links(text))
        .unwrap_or_default()
        .into_iter()
        .map(|(_, to)| resolved(INDEX, &to))
        .collect();
    let stray = pages.keys().filter(|path| path.starts_with("docs/") && *path != INDEX && !linked.contains(path));
    stray.map(|path| Violation::in_file(path, format!("is not linked from {INDEX}"))).collect()
}

fn page(path: &str, pages: &Pages, exists: &dyn Fn(&str) -> bool) -> Vec<Violation> {
    let text = &pages[path];
    let mut found = vec![];
    for (line, to) in links(text) {
        let (file, heading) = to.split_once('#').unwrap_or((&to, ""));
        let file = if file.is_empty() { path.to_owned() } else { resolved(path, file) };
        let known = pages
            .get(&file)
            .is_none_or(|text| heading.is_empty() || headings(text).iter().any(|known| known == heading));
        if !exists(&file) || !known {
            found.push(Violation::at(path, line, format!("the link to {to} leads nowhere")));
        }
    }
    for (line, named) in paths(text).filter(|(_, named)| !exists(named)) {
        found.push(Violation::at(path, line, format!("there is no {named}")));
    }
    found
}

/// Lines outside fenced code, numbered from 1.
fn unfenced(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut fenced = false;
    text.lines().enumerate().filter_map(move |(i, line)| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        (!fence && !fenced).then_some((i + 1, line))
    })
}

/// Lines outside fenced code, without what stands in backquotes.
fn uncoded(text: &str) -> impl Iterator<Item = (usize, String)> {
    unfenced(text).map(|(number, line)| (number, line.split('`').step_by(2).collect::<Vec<_>>().join("`")))
}

/// Paths of the workspace in backquotes.
fn paths(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let coded =
        unfenced(text).flat_map(|(number, line)| line.split('`').skip(1).step_by(2).map(move |code| (number, code)));
    coded.filter(|(_, code)| {
        ["crates/", "docs/", "fuzz/", "tests/", "xtask/"].iter().any(|root| code.starts_with(root))
            && code.chars().all(|c| c.is_alphanumeric() || "/._-".contains(c))
    })
}

/// Targets of links and pictures into the workspace, with their lines.
fn links(text: &str) -> Vec<(usize, String)> {
    let mut found = vec![];
    for (number, line) in uncoded(text) {
        for part in line.split("](").skip(1) {
            let to = part.split([')', ' ']).next().unwrap_or_default();
            if !to.contains("://") && !to.starts_with("mailto:") {
                found.push((number, to.to_owned()));
            }
        }
    }
    found
}

/// A path relative to a page, from the root.
fn resolved(page: &str, to: &str) -> String {
    let to = to.split('#').next().unwrap_or_default();
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in to.split('/') {
        match part {
            "." | "" => {}
            ".." => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// Names by which the headings of a page are linked.
fn headings(text: &str) -> Vec<String> {
    let heading = |(_, line): (usize, &str)| {
        let title = line.strip_prefix('#')?.trim_start_matches('#').strip_prefix(' ')?;
        let kept =
            title.to_lowercase().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>();
        Some(kept.replace(' ', "-"))
    };
    unfenced(text).filter_map(heading).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Vec<String> {
        let other = "# Other\n\n## Two words, `code`\n".to_owned();
        let pages = Pages::from([("docs/a.md".into(), text.to_owned()), ("docs/b/other.md".into(), other)]);
        let exists = |path: &str| pages.contains_key(path) || path == "docs/x.svg";
        page("docs/a.md", &pages, &exists).into_iter().map(|violation| violation.what).collect()
    }

    #[test]
    fn links_that_lead_nowhere_are_caught() {
        let good = "[a](b/other.md) ![b](x.svg) [c](https://a.b/c) [d](b/other.md#two-words-code) [e](#here)\n\n# Here\n\n`[f](no)`\n```\n[g](no)\n```";
        assert_eq!(found(good), [""; 0]);
        for bad in ["[a](b/others.md)", "[a](../x.svg)", "[a](b/other.md#three)", "[a](#there)", "[a\nb](no.md)"] {
            assert_eq!(found(bad).len(), 1, "{bad}");
        }
    }

    #[test]
    fn paths_that_are_not_there_are_caught() {
        assert_eq!(found("`docs/x.svg` `docs/b/other.md` `crates/*/tests` `docs x`"), [""; 0]);
        assert_eq!(found("`crates/none.rs`").len(), 1);
    }

    #[test]
    fn pages_that_nobody_finds_are_caught() {
        let mut pages =
            Pages::from([(INDEX.into(), "[a](guide/a.md)".into()), ("docs/guide/a.md".into(), String::new())]);
        assert_eq!(unlisted(&pages), []);
        pages.insert("docs/guide/b.md".into(), String::new());
        assert_eq!(unlisted(&pages).len(), 1);
    }
}
