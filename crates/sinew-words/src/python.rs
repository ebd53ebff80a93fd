//! The words of the command line as Python writes them: keyword arguments in place of flags.
//!
//! Flags stand between backquotes, alone or behind `sinew track`; commands that Python lacks stay as they are.

use sinew::config::setting::SettingKind;
use sinew::config::table::find;

/// Where the settings are listed, and what the command line says of it.
const LISTED: [(&str, &str); 2] =
    [("`sinew track --help` lists", "`sinew.settings()` lists"), ("; `--print-config` shows the values in force", "")];

/// A text in the notation of the command line, with keyword arguments: `lag={"cam_02": 3}` for `--lag cam_02=3`.
#[must_use]
pub fn in_python(text: &str) -> String {
    let text = LISTED.iter().fold(text.to_owned(), |text, (typed, python)| text.replace(typed, python));
    let rewritten = |(at, part): (usize, &str)| match at % 2 {
        1 => span(part).unwrap_or_else(|| part.to_owned()),
        _ => part.split('\n').map(line).collect::<Vec<_>>().join("\n"),
    };
    text.split('`').enumerate().map(rewritten).collect::<Vec<_>>().join("`")
}

/// A line on which a command stands by itself, indented.
fn line(text: &str) -> String {
    let command = text.strip_prefix("  ").and_then(span);
    command.map_or_else(|| text.to_owned(), |command| format!("  {command}"))
}

/// What stands between two backquotes, if it holds flags of ours.
fn span(text: &str) -> Option<String> {
    let call = text.strip_prefix("sinew track ");
    let mut arguments: Vec<String> = vec![];
    let mut words = call.unwrap_or(text).split(' ').peekable();
    while let Some(word) = words.next() {
        let key = match word {
            "-o" => "out".to_owned(),
            // Flags of other programs have underscores.
            _ => word.strip_prefix("--").filter(|flag| !flag.contains('_'))?.replace('-', "_"),
        };
        let given = words.next_if(|next| !next.starts_with("--") && *next != "-o");
        let is_switch = key == "resume" || find(&key).is_some_and(|setting| setting.kind == SettingKind::Flag);
        arguments.push(match given {
            Some(given) => format!("{key}={}", value(given)),
            None if is_switch => format!("{key}=True"),
            None => key,
        });
    }
    let arguments = arguments.join(", ");
    Some(if call.is_some() { format!("sinew.track({arguments})") } else { arguments })
}

/// A value as Python writes it.
fn value(typed: &str) -> String {
    let number = |text: &str| text.parse::<f64>().is_ok_and(f64::is_finite);
    let pairs = typed.split(',').map(|pair| pair.split_once('=').filter(|(_, value)| number(value)));
    if let Some(pairs) = pairs.collect::<Option<Vec<_>>>() {
        let pairs: Vec<String> = pairs.iter().map(|(name, value)| format!("{name:?}: {value}")).collect();
        return format!("{{{}}}", pairs.join(", "));
    }
    match typed.split_once("..") {
        Some((first, end)) => format!("({first}, {end})"),
        None if number(typed) => typed.to_owned(),
        None => format!("{typed:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_become_keyword_arguments() {
        let check = |typed: &str, python: &str| assert_eq!(in_python(typed), python);
        check("leave `--setup` out, or check", "leave `setup` out, or check");
        check("`--lag cam_02=3,cam_03=-1.5` reads", "`lag={\"cam_02\": 3, \"cam_03\": -1.5}` reads");
        check("`--outlier 0.05`; `--frames A..B`", "`outlier=0.05`; `frames=(A, B)`");
        check(
            "begin again with `--force` instead of `--resume`",
            "begin again with `force=True` instead of `resume=True`",
        );
        check("give that file with `--person 2 --setup`", "give that file with `person=2, setup`");
        check("choose another folder with `-o`", "choose another folder with `out`");
        check("`--any-size` takes the person", "`any_size=True` takes the person");
        check("or begin with `--init POINTS.trc`", "or begin with `init=\"POINTS.trc\"`");
        check("try\n  sinew track --keypoints pose --fps 60", "try\n  sinew.track(keypoints=\"pose\", fps=60)");
    }

    #[test]
    fn all_else_stays() {
        for text in
            ["OpenPose with `--write_json`, and", "with `sinew inspect`", "`mask_scale = 0.5`", "a - b -- c", "`"]
        {
            assert_eq!(in_python(text), text);
        }
        assert_eq!(
            in_python("`sinew track --help` lists the settings; `--print-config` shows the values in force"),
            "`sinew.settings()` lists the settings"
        );
    }
}
