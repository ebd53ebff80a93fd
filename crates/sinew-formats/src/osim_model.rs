//! Names of bodies and coordinates in a model of OpenSim (`.osim`).
//! Settings for its tools need no more.
//!
//! Versions 3 (`<BodySet>` with a `ground`) and 4 are read. Names are attributes of `<Body>` and `<Coordinate>`, wherever
//! they stand in the model.
//!
//! ```
//! let text = "<OpenSimDocument Version='40000'><Model name='m'><BodySet><objects><Body name='pelvis'/></objects>
//!             </BodySet></Model></OpenSimDocument>";
//! assert_eq!(sinew_formats::osim_model::read("m.osim", text)?.bodies, ["pelvis"]);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::xml_text::Xml;
use crate::{Error, Place};

/// Names in a model.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OsimModel {
    /// Bodies, in the order of the file.
    pub bodies: Vec<String>,
    /// Coordinates of its joints, in the order of the file.
    pub coordinates: Vec<String>,
}

/// Reads a model.
///
/// # Errors
/// XML that is malformed, and a document that is no model or has no bodies.
pub fn read(name: &str, text: &str) -> Result<OsimModel, Error> {
    let xml = Xml::parse(name, text)?;
    let root = xml.root();
    let missing = |field: &str| Place::file(name).lacks(field);
    let model = root.named("Model").next().filter(|_| root.name() == "OpenSimDocument");
    let model = model.ok_or_else(|| missing("<OpenSimDocument> with <Model>"))?;
    let mut found = OsimModel::default();
    for element in model.descendants() {
        let names = match element.name() {
            "Body" => &mut found.bodies,
            "Coordinate" => &mut found.coordinates,
            _ => continue,
        };
        names.extend(element.attribute("name").map(String::from));
    }
    if found.bodies.is_empty() { Err(missing("<Body name=\"…\">")) } else { Ok(found) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_in_the_order_of_the_file() {
        let text = "<?xml version=\"1.0\"?><OpenSimDocument Version=\"40000\"><Model name=\"a\"><BodySet name=\"b\"><objects>\
                    <Body name=\"pelvis\"><mass>1</mass></Body><Body name=\"femur_r\"/></objects></BodySet><JointSet><objects>\
                    <PinJoint name=\"hip_r\"><coordinates><Coordinate name=\"hip_flexion_r\"/></coordinates></PinJoint>\
                    </objects></JointSet></Model></OpenSimDocument>";
        let found = read("a.osim", text).unwrap();
        assert_eq!(found.bodies, ["pelvis", "femur_r"]);
        assert_eq!(found.coordinates, ["hip_flexion_r"]);
    }

    #[test]
    fn files_of_no_model_are_refused() {
        for text in
            ["<a/>", "<OpenSimDocument><MarkerSet/></OpenSimDocument>", "<OpenSimDocument><Model/></OpenSimDocument>"]
        {
            assert!(read("a.osim", text).unwrap_err().to_string().starts_with("a.osim"), "{text}");
        }
        assert!(read("a.osim", "time,x\n").is_err());
    }
}
