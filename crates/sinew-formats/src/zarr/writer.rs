//! Streams frames into a store.

use super::metadata::{self, Element, chunk_key};
use super::schema::{CHUNK_FRAMES, Constant, DataType, FRAME, FrameValues, Group, Labels, Schema, Store, Variable};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::io;

/// Name of the coordinate that holds the seconds of the frames.
const TIME: &str = "time";

/// Writes a store frame by frame.
pub struct Writer<S> {
    store: S,
    attributes: Map<String, Value>,
    /// Documents that never change, by path.
    fixed: Map<String, Value>,
    /// Arrays over `frame`: for each group its variables, then `frame` and `time`.
    growing: Vec<Growing>,
    /// Where the coordinates `frame` and `time` are among the growing arrays.
    is_time: Vec<Option<Time>>,
    frames: usize,
}

#[derive(Clone, Copy, PartialEq)]
enum Time {
    Number,
    Seconds,
}

/// An array over `frame` with its open chunk.
struct Growing {
    path: String,
    variable: Variable,
    /// Number of elements in the dimensions before and after `frame`.
    outer: usize,
    inner: usize,
    /// Shape with 1 for `frame`.
    shape: Vec<usize>,
    frame_axis: usize,
    chunk: Vec<u8>,
}

/// A store while its schema is checked.
struct Plan<S> {
    store: S,
    dimensions: BTreeMap<String, Labels>,
    /// Paths that are taken.
    paths: BTreeSet<String>,
    fixed: Map<String, Value>,
    growing: Vec<(Growing, Option<Time>)>,
}

fn labels<'a>(dimensions: &'a BTreeMap<String, Labels>, name: &str) -> io::Result<&'a Labels> {
    let found = dimensions.get(name).filter(|labels| !labels.is_empty());
    found.ok_or_else(|| invalid(format!("dimension `{name}` has no labels")))
}

impl<S: Store> Plan<S> {
    fn claim(&mut self, path: &str) -> io::Result<()> {
        let odd = path.split('/').any(|part| part.is_empty() || part.starts_with('.') || part.starts_with("__"));
        if odd || path.contains(char::is_control) || !self.paths.insert(path.to_owned()) {
            return Err(invalid(format!("`{path}` cannot be a path in a store, or is there twice")));
        }
        Ok(())
    }

    fn put_coordinates(&mut self, group: &Group) -> io::Result<()> {
        for name in coordinates(group) {
            let path = format!("{}/{name}", group.name);
            self.claim(&path)?;
            let labels = labels(&self.dimensions, &name)?;
            let (element, bytes) = match labels {
                Labels::Count(count) => {
                    let bytes = (0..*count as i64).flat_map(i64::to_le_bytes).collect();
                    (Element::Number(DataType::Int64), bytes)
                }
                Labels::Names(names) => (Element::Text, vlen_utf8(names)?),
            };
            let shape = [labels.len()];
            self.store.put(&format!("{path}/{}", chunk_key([0])), &bytes)?;
            self.fixed.insert(path, metadata::array(element, &shape, &shape, &[name], &Map::new()));
        }
        Ok(())
    }

    fn put_constant(&mut self, group: &str, constant: &Constant) -> io::Result<()> {
        let Variable { name, dimensions, data_type, attributes } = &constant.variable;
        let path = format!("{group}/{name}");
        self.claim(&path)?;
        let sizes = dimensions.iter().map(|name| Ok(labels(&self.dimensions, name)?.len()));
        let shape = sizes.collect::<io::Result<Vec<usize>>>()?;
        let is_growing = dimensions.iter().any(|name| name == FRAME);
        if is_growing || shape.iter().product::<usize>() != constant.values.len() {
            let count = constant.values.len();
            return Err(invalid(format!("`{path}` has {count} values for the shape {shape:?}")));
        }
        let key = format!("{path}/{}", chunk_key(shape.iter().map(|_| 0)));
        let bytes: Vec<u8> = constant.values.iter().flat_map(|&value| encoded(*data_type, value)).collect();
        self.store.put(&key, &bytes)?;
        let element = Element::Number(*data_type);
        self.fixed.insert(path, metadata::array(element, &shape, &shape, dimensions, attributes));
        Ok(())
    }

    /// Takes up the variables of a group that grow, with its coordinates `frame` and `time`.
    fn grow(&mut self, group: Group) -> io::Result<()> {
        let streams = !group.variables.is_empty();
        let times = [(FRAME, DataType::Int64, Time::Number), (TIME, DataType::Float64, Time::Seconds)];
        let times = times.into_iter().filter(|_| streams).map(|(name, data_type, time)| {
            let variable = Variable::new(name, &[FRAME], data_type);
            (if time == Time::Seconds { variable.with_attribute("units", "s") } else { variable }, Some(time))
        });
        let variables =
            group.variables.into_iter().map(|variable| (variable.with_attribute("coordinates", TIME), None));
        for (variable, time) in variables.chain(times) {
            let path = format!("{}/{}", group.name, variable.name);
            self.claim(&path)?;
            let size =
                |name: &String| if name == FRAME { Ok(1) } else { labels(&self.dimensions, name).map(Labels::len) };
            let shape = variable.dimensions.iter().map(size).collect::<io::Result<Vec<usize>>>()?;
            self.growing.push((Growing::new(path, variable, shape)?, time));
        }
        Ok(())
    }
}

impl<S: Store> Writer<S> {
    /// Checks the schema and writes everything that does not grow.
    ///
    /// # Errors
    /// What the store reports; `InvalidInput` for dimensions without labels, names that are used twice or cannot be part of
    /// a path, growing variables without `frame`, constants with it or of another size.
    pub fn create(store: S, schema: Schema) -> io::Result<Self> {
        let Schema { dimensions, attributes, groups } = schema;
        let mut plan = Plan { store, dimensions, paths: BTreeSet::new(), fixed: Map::new(), growing: vec![] };
        for group in groups {
            plan.claim(&group.name)?;
            plan.fixed.insert(group.name.clone(), metadata::group(&group.attributes));
            plan.put_coordinates(&group)?;
            for constant in &group.constants {
                plan.put_constant(&group.name, constant)?;
            }
            plan.grow(group)?;
        }
        let Plan { store, fixed, growing, .. } = plan;
        let (growing, is_time) = growing.into_iter().unzip();
        let mut writer = Self { store, attributes, fixed, growing, is_time, frames: 0 };
        for (path, document) in &writer.fixed {
            writer.store.put(&format!("{path}/zarr.json"), &metadata::bytes(document))?;
        }
        writer.store.put("zarr.json", &metadata::bytes(&metadata::group(&writer.attributes)))?;
        writer.put_growing_metadata(CHUNK_FRAMES)?;
        Ok(writer)
    }

    /// Frames pushed so far.
    #[must_use]
    pub const fn frames(&self) -> usize {
        self.frames
    }

    /// Appends a frame: its number, its time, and the values of every growing variable in the order of the schema.
    ///
    /// # Errors
    /// What the store reports; `InvalidInput` for values that are too many, too few or of the wrong kind. The frame is then
    /// not counted.
    pub fn push(&mut self, number: i64, time_s: f64, values: &[FrameValues<'_>]) -> io::Result<()> {
        let expected = self.is_time.iter().filter(|time| time.is_none()).count();
        if values.len() != expected {
            return Err(invalid(format!("{} variables given, the store has {expected}", values.len())));
        }
        let place = self.frames % CHUNK_FRAMES;
        let mut given = values.iter();
        for (array, time) in self.growing.iter_mut().zip(&self.is_time) {
            match time {
                Some(Time::Number) => array.set(place, FrameValues::Integers(&[number]))?,
                Some(Time::Seconds) => array.set(place, FrameValues::Numbers(&[time_s]))?,
                None => given.next().map_or(Ok(()), |&values| array.set(place, values))?,
            }
        }
        self.frames += 1;
        if self.frames.is_multiple_of(CHUNK_FRAMES) { self.flush(CHUNK_FRAMES) } else { Ok(()) }
    }

    /// The open chunk of every growing variable, with what is still to come at its fill value.
    pub fn open_chunks(&self) -> impl Iterator<Item = &[u8]> {
        self.growing.iter().map(|array| &array.chunk[..])
    }

    /// Resumes where a writer of the same schema had pushed `frames` frames and had these open chunks. Its store is written over from there; the keys of chunks that lie further are given to `stale`.
    ///
    /// # Errors
    /// What the store and `stale` report; `InvalidInput` for chunks of another schema.
    pub fn resume(
        mut self,
        frames: usize,
        chunks: &[impl AsRef<[u8]>],
        mut stale: impl FnMut(&mut S, &str) -> io::Result<bool>,
    ) -> io::Result<Self> {
        let fit = self.growing.iter().zip(chunks).all(|(array, chunk)| array.chunk.len() == chunk.as_ref().len());
        if !fit || chunks.len() != self.growing.len() {
            return Err(invalid("the open chunks belong to another schema".into()));
        }
        for (array, chunk) in self.growing.iter_mut().zip(chunks) {
            array.chunk.copy_from_slice(chunk.as_ref());
            let mut number = frames / CHUNK_FRAMES;
            while stale(&mut self.store, &array.key(number))? {
                number += 1;
            }
        }
        self.frames = frames;
        self.put_growing_metadata(CHUNK_FRAMES)?;
        Ok(self)
    }

    /// The store.
    pub const fn store_mut(&mut self) -> &mut S {
        &mut self.store
    }

    /// Writes the open chunk, shapes and consolidated metadata, and gives the store back. A store with a single chunk has it without padding.
    ///
    /// # Errors
    /// What the store reports.
    pub fn finish(mut self) -> io::Result<S> {
        let mut chunk_frames = CHUNK_FRAMES;
        if !self.frames.is_multiple_of(CHUNK_FRAMES) {
            if self.frames < CHUNK_FRAMES {
                chunk_frames = self.frames;
                self.growing.iter_mut().for_each(|array| array.shorten(chunk_frames));
            }
            self.flush(chunk_frames)?;
        }
        let mut nodes = std::mem::take(&mut self.fixed);
        nodes.extend(self.growing.iter().map(|array| (array.path.clone(), array.metadata(self.frames, chunk_frames))));
        let root = metadata::consolidated_root(&self.attributes, nodes);
        self.store.put("zarr.json", &metadata::bytes(&root))?;
        Ok(self.store)
    }

    /// Writes the open chunk; `chunk_frames` is the length of all.
    fn flush(&mut self, chunk_frames: usize) -> io::Result<()> {
        let chunk = self.frames.saturating_sub(1) / CHUNK_FRAMES;
        for array in &mut self.growing {
            self.store.put(&array.key(chunk), &array.chunk)?;
            array.clear();
        }
        self.put_growing_metadata(chunk_frames)
    }

    fn put_growing_metadata(&mut self, chunk_frames: usize) -> io::Result<()> {
        for array in &self.growing {
            let document = metadata::bytes(&array.metadata(self.frames, chunk_frames));
            self.store.put(&format!("{}/zarr.json", array.path), &document)?;
        }
        Ok(())
    }
}

impl Growing {
    fn new(path: String, variable: Variable, shape: Vec<usize>) -> io::Result<Self> {
        let mut frame_axes = variable.dimensions.iter().enumerate().filter(|(_, name)| *name == FRAME).map(|(i, _)| i);
        let (Some(frame_axis), None) = (frame_axes.next(), frame_axes.next()) else {
            return Err(invalid(format!("`{path}` must have the dimension `frame` once")));
        };
        let outer = shape.iter().take(frame_axis).product();
        let inner = shape.iter().skip(frame_axis).product();
        let mut array = Self { path, variable, outer, inner, shape, frame_axis, chunk: Vec::new() };
        array.clear();
        Ok(array)
    }

    fn clear(&mut self) {
        let elements = self.outer * CHUNK_FRAMES * self.inner;
        let fill = match self.variable.data_type {
            DataType::Float32 | DataType::Float64 => f64::NAN,
            DataType::Int64 | DataType::Bool => 0.0,
        };
        let fill: Vec<u8> = encoded(self.variable.data_type, fill).collect();
        self.chunk = fill.repeat(elements);
    }

    fn set(&mut self, place: usize, values: FrameValues<'_>) -> io::Result<()> {
        let expected = self.outer * self.inner;
        let data_type = self.variable.data_type;
        let fits = matches!(
            (values, data_type),
            (FrameValues::Numbers(_), DataType::Float32 | DataType::Float64)
                | (FrameValues::Integers(_), DataType::Int64)
                | (FrameValues::Flags(_), DataType::Bool)
        );
        if !fits || values.len() != expected {
            return Err(invalid(format!("`{}` takes {expected} values as {data_type:?} a frame", self.path)));
        }
        let bytes: Vec<u8> = match values {
            FrameValues::Numbers(values) => values.iter().flat_map(|&value| encoded(data_type, value)).collect(),
            FrameValues::Integers(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            FrameValues::Flags(values) => values.iter().map(|&flag| u8::from(flag)).collect(),
        };
        let row = bytes.len() / self.outer;
        let slabs = self.chunk.chunks_exact_mut(CHUNK_FRAMES * row);
        for (slab, new) in slabs.zip(bytes.chunks_exact(row)) {
            slab[place * row..(place + 1) * row].copy_from_slice(new);
        }
        Ok(())
    }

    fn key(&self, chunk: usize) -> String {
        let places = (0..self.shape.len()).map(|axis| if axis == self.frame_axis { chunk } else { 0 });
        format!("{}/{}", self.path, chunk_key(places))
    }

    /// Leaves nothing of the chunk but its first frames.
    fn shorten(&mut self, frames: usize) {
        let slab = self.chunk.len() / self.outer.max(1);
        let kept = slab / CHUNK_FRAMES * frames;
        self.chunk = self.chunk.chunks_exact(slab.max(1)).flat_map(|slab| &slab[..kept]).copied().collect();
    }

    fn metadata(&self, frames: usize, chunk_frames: usize) -> Value {
        let with_frames = |frames: usize| {
            let mut shape = self.shape.clone();
            shape.iter_mut().skip(self.frame_axis).take(1).for_each(|size| *size = frames);
            shape
        };
        let Variable { dimensions, data_type, attributes, .. } = &self.variable;
        let element = Element::Number(*data_type);
        metadata::array(element, &with_frames(frames), &with_frames(chunk_frames), dimensions, attributes)
    }
}

/// Dimensions of a group but `frame`, each once.
fn coordinates(group: &Group) -> Vec<String> {
    let variables = group.variables.iter().chain(group.constants.iter().map(|constant| &constant.variable));
    let names: BTreeSet<&String> = variables.flat_map(|variable| &variable.dimensions).collect();
    names.into_iter().filter(|name| *name != FRAME).cloned().collect()
}

fn encoded(data_type: DataType, value: f64) -> impl Iterator<Item = u8> + Clone {
    let (bytes, length) = match data_type {
        DataType::Float32 => {
            let [a, b, c, d] = (value as f32).to_le_bytes();
            ([a, b, c, d, 0, 0, 0, 0], 4)
        }
        DataType::Float64 => (value.to_le_bytes(), 8),
        DataType::Int64 => ((value as i64).to_le_bytes(), 8),
        DataType::Bool => ([u8::from(value != 0.0), 0, 0, 0, 0, 0, 0, 0], 1),
    };
    bytes.into_iter().take(length)
}

fn vlen_utf8(names: &[String]) -> io::Result<Vec<u8>> {
    let length = |n: usize| u32::try_from(n).map_err(|_| invalid("too many or too long names".into()));
    let mut out = length(names.len())?.to_le_bytes().to_vec();
    for name in names {
        out.extend(length(name.len())?.to_le_bytes());
        out.extend(name.as_bytes());
    }
    Ok(out)
}

fn invalid(what: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, what)
}
