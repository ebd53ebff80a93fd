//! Bodies of files, in the format that the content is in: `body.toml` or URDF.

use crate::body_toml::{self, BodyDefinition};
use crate::source_text::without_mark;
use crate::{Error, urdf};

/// Reads a body: URDF where the text is XML, else [`body_toml`].
///
/// # Errors
/// Those of [`urdf::read`] and [`body_toml::read`].
pub fn read(name: &str, text: &str) -> Result<BodyDefinition, Error> {
    if without_mark(text).trim_start().starts_with('<') {
        return urdf::read(name, text).map(|robot| BodyDefinition { tree: robot.tree, flesh: None });
    }
    body_toml::read(name, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_is_the_same_from_either_format() {
        let urdf = "\u{feff}<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='prismatic'>\
                    <parent link='a'/><child link='b'/><axis xyz='0 3 4'/></joint></robot>";
        let robot = read("r.urdf", urdf).unwrap();
        assert_eq!(read("r.toml", &body_toml::write(&robot.tree, None)).unwrap(), robot);
    }
}
