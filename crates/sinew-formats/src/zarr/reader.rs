//! Arrays of numbers, read back as [`super::Writer`] writes them.

use crate::Error;
use crate::json_text;
use crate::place::Place;
use serde_json::Value;

/// An array of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberArray {
    /// Length along each dimension.
    pub shape: Vec<usize>,
    /// Its values, the last dimension fastest.
    pub values: Vec<f64>,
}

/// Most numbers of an array.
const MOST: usize = 1 << 28;

/// Reads an array of `float32` or `float64` from the text of its `zarr.json`, called `name` in messages; `chunk` gives the bytes of a key below the array, or `None` where there is no such chunk.
///
/// # Errors
/// A document that is malformed or describes another kind of array, and a chunk of another length.
pub fn numbers(
    name: &str,
    document: &str,
    mut chunk: impl FnMut(&str) -> Result<Option<Vec<u8>>, Error>,
) -> Result<NumberArray, Error> {
    let document: Value = json_text::parse(name, document)?;
    let wrong =
        |found: String, expected: &str| Error::Syntax { place: Place::file(name), found, expected: expected.into() };
    let refused = |key: &str, expected: &str| wrong(format!("`{key}`: {}", document[key]), expected);
    let sizes = |value: &Value| -> Option<Vec<usize>> {
        value.as_array()?.iter().map(|size| usize::try_from(size.as_u64()?).ok()).collect()
    };
    let shape = sizes(&document["shape"]).ok_or_else(|| refused("shape", "a list of counts"))?;
    let cut = sizes(&document["chunk_grid"]["configuration"]["chunk_shape"]);
    let cut = cut.filter(|cut| cut.len() == shape.len() && cut.iter().all(|size| *size > 0));
    let cut = cut.ok_or_else(|| refused("chunk_grid", "a `chunk_shape` with a count above 0 for each dimension"))?;
    let width = match document["data_type"].as_str() {
        Some("float32") => 4,
        Some("float64") => 8,
        _ => return Err(refused("data_type", "float32 or float64")),
    };
    if document["codecs"].as_array().is_none_or(|codecs| codecs.len() != 1 || codecs[0]["name"] != "bytes") {
        return Err(refused("codecs", "`bytes` alone, without compression"));
    }
    let product = |sizes: &[usize]| sizes.iter().try_fold(1_usize, |all, size| all.checked_mul(*size));
    let (Some(total), Some(in_chunk)) = (product(&shape).filter(|n| *n <= MOST), product(&cut).filter(|n| *n <= MOST))
    else {
        return Err(refused("shape", "fewer numbers"));
    };
    let mut values = vec![f64::NAN; total];
    let grid: Vec<usize> = shape.iter().zip(&cut).map(|(size, cut)| size.div_ceil(*cut)).collect();
    for number in 0..product(&grid).unwrap_or(0) {
        let at = places(number, &grid);
        let key = std::iter::once("c".to_owned()).chain(at.iter().map(usize::to_string)).collect::<Vec<_>>().join("/");
        let Some(bytes) = chunk(&key)? else { continue };
        if bytes.len() != width * in_chunk {
            return Err(wrong(format!("chunk {key} has {} bytes", bytes.len()), &(width * in_chunk).to_string()));
        }
        for (within, bytes) in bytes.chunks_exact(width).enumerate() {
            let place: Vec<usize> =
                places(within, &cut).iter().zip(at.iter().zip(&cut)).map(|(w, (a, c))| a * c + w).collect();
            if place.iter().zip(&shape).all(|(place, size)| place < size) {
                let index = place.iter().zip(&shape).fold(0, |index, (place, size)| index * size + place);
                values[index] = match bytes {
                    [a, b, c, d] => f64::from(f32::from_le_bytes([*a, *b, *c, *d])),
                    _ => f64::from_le_bytes(bytes.try_into().unwrap_or_default()),
                };
            }
        }
    }
    Ok(NumberArray { shape, values })
}

/// Place along each dimension of the n-th entry.
fn places(mut number: usize, sizes: &[usize]) -> Vec<usize> {
    let mut places = vec![0; sizes.len()];
    for (place, size) in places.iter_mut().zip(sizes).rev() {
        (*place, number) = (number % size, number / size);
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::zarr::{DataType, FrameValues, Group, Labels, MemoryStore, Schema, Variable, Writer};

    fn written(frames: usize) -> MemoryStore {
        let mut schema = Schema::default();
        schema.dimensions.insert("draw".into(), Labels::Count(2));
        schema.dimensions.insert("axis".into(), Labels::Count(3));
        let mut posterior = Group::new("posterior");
        posterior.variables.push(Variable::new("place", &["draw", "frame", "axis"], DataType::Float32));
        schema.groups.push(posterior);
        let mut writer = Writer::create(MemoryStore::default(), schema).unwrap();
        for frame in 0..frames {
            let values: Vec<f64> = (0..6).map(|k| (10 * frame + k) as f64).collect();
            writer.push(frame as i64, 0.0, &[FrameValues::Numbers(&values)]).unwrap();
        }
        writer.finish().unwrap()
    }

    fn read(store: &MemoryStore, change: impl Fn(String) -> String) -> Result<NumberArray, Error> {
        let document = String::from_utf8(store.0["posterior/place/zarr.json"].clone()).unwrap();
        numbers("place", &change(document), |key| Ok(store.0.get(&format!("posterior/place/{key}")).cloned()))
    }

    #[test]
    fn written_arrays_are_read() {
        let found = read(&written(70), |document| document).unwrap();
        assert_eq!(found.shape, [2, 70, 3]);
        for draw in 0..2 {
            for frame in 0..70 {
                for axis in 0..3 {
                    assert_eq!(found.values[(draw * 70 + frame) * 3 + axis], (10 * frame + 3 * draw + axis) as f64);
                }
            }
        }
    }

    #[test]
    fn other_arrays_are_refused_in_words() {
        let store = written(2);
        let refused = |from: &str, to: &str| read(&store, |text| text.replace(from, to)).unwrap_err().to_string();
        assert_eq!(refused("float32", "int8"), "place: `data_type`: \"int8\"; expected float32 or float64");
        assert!(refused("\"bytes\"", "\"gzip\"").contains("without compression"));
        assert!(refused("float32", "float64").contains("chunk c/0/0/0 has 1536 bytes; expected 3072"));
        assert!(refused("\"shape\"", "\"form\"").contains("a list of counts"));
        let huge = read(&store, |text| text.replacen("\"shape\": [\n    2", "\"shape\": [\n    200000000000", 1));
        assert!(huge.unwrap_err().to_string().contains("fewer numbers"));
    }
}
