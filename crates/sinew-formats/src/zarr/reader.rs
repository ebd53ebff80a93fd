//! Arrays, read back as [`super::Writer`] writes them.

use super::metadata::chunk_key;
use crate::Error;
use crate::json_text;
use crate::place::Place;
use serde_json::{Map, Value};

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

/// Most texts of an array.
const MOST_TEXTS: usize = 1 << 20;

/// Most values of an array that may lack chunks, in whose places the fill value stands. Of a larger one all chunks must be there, so that no memory is taken for what was only promised.
const MOST_LACKING: usize = 1 << 20;

/// An array as it is stored.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredArray {
    /// Length along each dimension.
    pub shape: Vec<usize>,
    /// Name of each dimension.
    pub dimensions: Vec<String>,
    /// Attributes.
    pub attributes: Map<String, Value>,
    /// Its values, the last dimension fastest.
    pub values: StoredValues,
}

/// Values in the type in which they are stored.
#[derive(Clone, Debug, PartialEq)]
pub enum StoredValues {
    /// 32-bit floats.
    Float32(Vec<f32>),
    /// 64-bit floats.
    Float64(Vec<f64>),
    /// 64-bit integers.
    Int64(Vec<i64>),
    /// Booleans.
    Bool(Vec<bool>),
    /// Texts.
    Text(Vec<String>),
}

/// Reads an array of `float32` or `float64` as [`array()`] does.
///
/// # Errors
/// As [`array()`]; an array of another type.
pub fn numbers(
    name: &str,
    document: &str,
    chunk: impl FnMut(&str) -> Result<Option<Vec<u8>>, Error>,
) -> Result<NumberArray, Error> {
    let parsed = Parsed::new(name, document)?;
    let StoredArray { shape, values, .. } = match parsed.document["data_type"].as_str() {
        Some("float32" | "float64") => parsed.read(chunk)?,
        _ => return Err(parsed.refused("data_type", "float32 or float64")),
    };
    let values = match values {
        StoredValues::Float32(values) => values.into_iter().map(f64::from).collect(),
        StoredValues::Float64(values) => values,
        _ => return Err(parsed.refused("data_type", "float32 or float64")),
    };
    Ok(NumberArray { shape, values })
}

/// Reads an array from the text of its `zarr.json`, called `name` in messages; `chunk` gives the bytes of a key below the array, or `None` where there is no such chunk.
///
/// # Errors
/// A document that is malformed or describes another kind of array than [`super::Writer`] writes, and a chunk of another length.
pub fn array(
    name: &str,
    document: &str,
    chunk: impl FnMut(&str) -> Result<Option<Vec<u8>>, Error>,
) -> Result<StoredArray, Error> {
    Parsed::new(name, document)?.read(chunk)
}

/// The document of an array.
struct Parsed<'a> {
    name: &'a str,
    document: Value,
}

impl<'a> Parsed<'a> {
    fn new(name: &'a str, document: &str) -> Result<Self, Error> {
        Ok(Self { name, document: json_text::parse(name, document)? })
    }

    fn wrong(&self, found: String, expected: &str) -> Error {
        Place::file(self.name).syntax(found, expected)
    }

    fn refused(&self, key: &str, expected: &str) -> Error {
        self.wrong(format!("`{key}`: {}", self.document[key]), expected)
    }

    /// The length along each dimension, of the array and of a chunk.
    fn sizes(&self) -> Result<[Vec<usize>; 2], Error> {
        let sizes = |value: &Value| -> Option<Vec<usize>> {
            value.as_array()?.iter().map(|size| usize::try_from(size.as_u64()?).ok()).collect()
        };
        let shape = sizes(&self.document["shape"]).ok_or_else(|| self.refused("shape", "a list of counts"))?;
        let cut = sizes(&self.document["chunk_grid"]["configuration"]["chunk_shape"]);
        let cut = cut.filter(|cut| cut.len() == shape.len() && cut.iter().all(|size| *size > 0));
        let expected = "a `chunk_shape` with a count above 0 for each dimension";
        Ok([shape, cut.ok_or_else(|| self.refused("chunk_grid", expected))?])
    }

    fn read(&self, chunk: impl FnMut(&str) -> Result<Option<Vec<u8>>, Error>) -> Result<StoredArray, Error> {
        let [shape, cut] = self.sizes()?;
        let names = self.document["dimension_names"].as_array().into_iter().flatten();
        let dimensions: Vec<String> = names.filter_map(|name| name.as_str().map(str::to_owned)).collect();
        let attributes = self.document["attributes"].as_object().cloned().unwrap_or_default();
        let kind = self.document["data_type"].as_str();
        let codec = if kind == Some("string") { "vlen-utf8" } else { "bytes" };
        let codecs = self.document["codecs"].as_array();
        if codecs.is_none_or(|codecs| codecs.len() != 1 || codecs[0]["name"] != codec) {
            return Err(self.refused("codecs", &format!("`{codec}` alone, without compression")));
        }
        if self.document["chunk_key_encoding"]["configuration"]["separator"] != "." {
            return Err(self.refused("chunk_key_encoding", "the separator `.`"));
        }
        let grid = Grid { parsed: self, shape: &shape, cut: &cut };
        let values = match kind {
            Some("float32") => StoredValues::Float32(grid.gather(f32::NAN, fixed(f32::from_le_bytes), chunk)?),
            Some("float64") => StoredValues::Float64(grid.gather(f64::NAN, fixed(f64::from_le_bytes), chunk)?),
            Some("int64") => StoredValues::Int64(grid.gather(0, fixed(i64::from_le_bytes), chunk)?),
            Some("bool") => StoredValues::Bool(grid.gather(false, fixed(|[byte]: [u8; 1]| byte != 0), chunk)?),
            Some("string") => StoredValues::Text(grid.gather_at_most(MOST_TEXTS, String::new(), texts, chunk)?),
            _ => return Err(self.refused("data_type", "float32, float64, int64, bool or string")),
        };
        Ok(StoredArray { shape, dimensions, attributes, values })
    }
}

/// Values of a chunk of `count`, or what is wrong with its length.
type Decoded<T> = Result<Vec<T>, String>;

/// Numbers of a fixed width.
fn fixed<const WIDTH: usize, T>(number: impl Fn([u8; WIDTH]) -> T) -> impl Fn(&[u8], usize) -> Decoded<T> {
    move |bytes, count| {
        let (numbers, _) = bytes.as_chunks::<WIDTH>();
        let fits = bytes.len() == WIDTH * count;
        if fits { Ok(numbers.iter().map(|bytes| number(*bytes)).collect()) } else { Err(format!("{}", WIDTH * count)) }
    }
}

/// Texts with their lengths before them, after their count.
fn texts(bytes: &[u8], count: usize) -> Decoded<String> {
    let wrong = || format!("{count} texts with their lengths");
    let mut rest = bytes.get(4..).ok_or_else(wrong)?;
    let mut found = Vec::new();
    while let Some((length, after)) = rest.split_first_chunk::<4>() {
        let (text, after) = after.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or_else(wrong)?;
        found.push(std::str::from_utf8(text).map_err(|_| wrong())?.to_owned());
        rest = after;
    }
    if found.len() == count { Ok(found) } else { Err(wrong()) }
}

/// An array cut into chunks.
struct Grid<'a> {
    parsed: &'a Parsed<'a>,
    shape: &'a [usize],
    cut: &'a [usize],
}

impl Grid<'_> {
    /// All numbers, from one chunk after the other.
    fn gather<T: Clone + Default>(
        &self,
        fill: T,
        decode: impl Fn(&[u8], usize) -> Decoded<T>,
        chunk: impl FnMut(&str) -> Result<Option<Vec<u8>>, Error>,
    ) -> Result<Vec<T>, Error> {
        self.gather_at_most(MOST, fill, decode, chunk)
    }

    fn gather_at_most<T: Clone + Default>(
        &self,
        most: usize,
        fill: T,
        decode: impl Fn(&[u8], usize) -> Decoded<T>,
        mut chunk: impl FnMut(&str) -> Result<Option<Vec<u8>>, Error>,
    ) -> Result<Vec<T>, Error> {
        let Self { parsed, shape, cut } = *self;
        let product = |sizes: &[usize]| sizes.iter().try_fold(1_usize, |all, size| all.checked_mul(*size));
        let (Some(total), Some(in_chunk)) =
            (product(shape).filter(|n| *n <= most), product(cut).filter(|n| *n <= most))
        else {
            return Err(parsed.refused("shape", "fewer numbers"));
        };
        // Zeros take no memory before something is written over them.
        let mut values = vec![if total > MOST_LACKING { T::default() } else { fill }; total];
        let grid: Vec<usize> = shape.iter().zip(cut).map(|(size, cut)| size.div_ceil(*cut)).collect();
        for number in 0..product(&grid).unwrap_or(0) {
            let at = places(number, &grid);
            let key = chunk_key(at.iter().copied());
            let Some(bytes) = chunk(&key)? else {
                if total > MOST_LACKING {
                    return Err(parsed.wrong(format!("{total} values and no chunk {key}"), "all chunks of so many"));
                }
                continue;
            };
            let decoded = decode(&bytes, in_chunk)
                .map_err(|due| parsed.wrong(format!("chunk {key} has {} bytes", bytes.len()), &due))?;
            self.place(&at, &decoded, &mut values);
        }
        Ok(values)
    }

    /// Puts the rows of a chunk, without its padding, where they belong.
    fn place<T: Clone>(&self, at: &[usize], chunk: &[T], values: &mut [T]) {
        let (Some((&size, shape)), Some((&width, cut)), Some((&column, at))) =
            (self.shape.split_last(), self.cut.split_last(), at.split_last())
        else {
            values.clone_from_slice(chunk);
            return;
        };
        let first = column * width;
        let length = width.min(size - first);
        for (number, row) in chunk.chunks_exact(width).enumerate() {
            let within = places(number, cut);
            let mut rows = within.iter().zip(at.iter().zip(cut)).map(|(within, (at, cut))| at * cut + within);
            let index = shape
                .iter()
                .try_fold(0, |index, size| rows.next().filter(|place| place < size).map(|place| index * size + place));
            if let Some(index) = index {
                values[index * size + first..][..length].clone_from_slice(&row[..length]);
            }
        }
    }
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
    fn arrays_keep_their_types_and_names() {
        let store = written(70);
        let read = |path: &str| {
            let document = String::from_utf8(store.0[&format!("posterior/{path}/zarr.json")].clone()).unwrap();
            array(path, &document, |key| Ok(store.0.get(&format!("posterior/{path}/{key}")).cloned())).unwrap()
        };
        let place = read("place");
        assert_eq!((place.dimensions.join(" "), place.shape), ("draw frame axis".into(), vec![2, 70, 3]));
        assert!(matches!(place.values, StoredValues::Float32(_)));
        assert_eq!(read("frame").values, StoredValues::Int64((0..70).collect()));
        assert_eq!(read("draw").values, StoredValues::Int64(vec![0, 1]));
    }

    #[test]
    fn texts_are_read_with_their_lengths() {
        let bytes = b"\x02\0\0\0\x01\0\0\0a\x03\0\0\0b\xc3\xa4";
        assert_eq!(texts(bytes, 2).unwrap(), ["a", "b\u{e4}"]);
        assert!(texts(bytes, 3).is_err() && texts(&bytes[..9 + 5], 2).is_err() && texts(b"", 0).is_err());
    }

    #[test]
    fn other_arrays_are_refused_in_words() {
        let store = written(2);
        let refused = |from: &str, to: &str| read(&store, |text| text.replace(from, to)).unwrap_err().to_string();
        assert_eq!(refused("float32", "int8"), "place: `data_type`: \"int8\"; expected float32 or float64");
        assert!(refused("\"bytes\"", "\"gzip\"").contains("without compression"));
        assert!(refused("\"separator\": \".\"", "\"separator\": \"/\"").contains("expected the separator `.`"));
        assert!(refused("float32", "float64").contains("chunk c.0.0.0 has 48 bytes; expected 96"));
        assert!(refused("\"shape\"", "\"form\"").contains("a list of counts"));
        let huge = read(&store, |text| text.replacen("\"shape\": [\n    2", "\"shape\": [\n    200000000000", 1));
        assert!(huge.unwrap_err().to_string().contains("fewer numbers"));
    }

    /// 2²⁸ numbers of which one chunk is there, and a million texts more than are read.
    #[test]
    fn promised_chunks_take_no_memory() {
        let promise = |kind: &str, codec: &str, count: usize| {
            format!(
                "{{\"shape\":[{count}],\"data_type\":\"{kind}\",\"chunk_grid\":{{\"configuration\":{{\"chunk_shape\":[2]}}}},\
                 \"chunk_key_encoding\":{{\"configuration\":{{\"separator\":\".\"}}}},\"codecs\":[{{\"name\":\"{codec}\"}}]}}"
            )
        };
        let first = |key: &str| Ok((key == "c.0").then(|| vec![0; 16]));
        let refused = numbers("place", &promise("float64", "bytes", 1 << 28), first).unwrap_err();
        assert_eq!(refused.to_string(), "place: 268435456 values and no chunk c.1; expected all chunks of so many");
        let refused = array("place", &promise("string", "vlen-utf8", (1 << 20) + 1), |_| Ok(None)).unwrap_err();
        assert!(refused.to_string().contains("fewer numbers"), "{refused}");
        let few = numbers("place", &promise("float64", "bytes", 3), first).unwrap();
        assert!(few.values[..2] == [0.0; 2] && few.values[2].is_nan());
    }
}
