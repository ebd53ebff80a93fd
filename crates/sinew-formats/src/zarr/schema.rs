//! What a store holds: dimensions, groups, variables and their values.

use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::io;

/// Frames in a chunk.
pub const CHUNK_FRAMES: usize = 64;

/// Name of the dimension that grows.
pub const FRAME: &str = "frame";

/// Where the parts of a store go: keys are paths with `/`.
pub trait Store {
    /// Writes a whole value, replacing what was there.
    ///
    /// # Errors
    /// What the medium reports.
    fn put(&mut self, key: &str, bytes: &[u8]) -> io::Result<()>;
}

/// A store in memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MemoryStore(pub BTreeMap<String, Vec<u8>>);

impl Store for MemoryStore {
    fn put(&mut self, key: &str, bytes: &[u8]) -> io::Result<()> {
        self.0.insert(key.to_owned(), bytes.to_vec());
        Ok(())
    }
}

impl<S: Store + ?Sized> Store for &mut S {
    fn put(&mut self, key: &str, bytes: &[u8]) -> io::Result<()> {
        (**self).put(key, bytes)
    }
}

/// How numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DataType {
    /// 32-bit floats; padding is NaN.
    Float32,
    /// 64-bit floats; padding is NaN.
    Float64,
    /// 64-bit integers; padding is 0.
    Int64,
    /// Booleans; padding is false.
    Bool,
}

/// Labels of a dimension.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Labels {
    /// 0, 1, 2, …
    Count(usize),
    /// Names.
    Names(Vec<String>),
}

impl Labels {
    /// How many.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Count(count) => *count,
            Self::Names(names) => names.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A variable that grows with the frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name.
    pub name: String,
    /// Dimensions, slowest first; one of them is `frame`.
    pub dimensions: Vec<String>,
    /// How it is stored.
    pub data_type: DataType,
    /// Attributes besides `coordinates`, for example `units`.
    pub attributes: Map<String, Value>,
}

impl Variable {
    /// A variable without further attributes.
    #[must_use]
    pub fn new(name: &str, dimensions: &[&str], data_type: DataType) -> Self {
        let dimensions = dimensions.iter().map(|&dimension| dimension.into()).collect();
        Self { name: name.into(), dimensions, data_type, attributes: Map::new() }
    }

    /// The same with an attribute.
    #[must_use]
    pub fn with_attribute(mut self, key: &str, value: impl Into<Value>) -> Self {
        self.attributes.insert(key.into(), value.into());
        self
    }
}

/// A variable that is known from the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    /// Name, dimensions (without `frame`), data type and attributes.
    pub variable: Variable,
    /// Values, last dimension fastest.
    pub values: Vec<f64>,
}

/// A group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// Name.
    pub name: String,
    /// Attributes.
    pub attributes: Map<String, Value>,
    /// Variables that grow, in the order in which their values are pushed.
    pub variables: Vec<Variable>,
    /// Variables that do not.
    pub constants: Vec<Constant>,
}

impl Group {
    /// A group without attributes and variables.
    #[must_use]
    pub fn new(name: &str) -> Self {
        Self { name: name.into(), ..Self::default() }
    }
}

/// Everything about a store but its numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Schema {
    /// Labels of every dimension but `frame`.
    pub dimensions: BTreeMap<String, Labels>,
    /// Attributes of the root.
    pub attributes: Map<String, Value>,
    /// Groups.
    pub groups: Vec<Group>,
}

/// Values of a variable for one frame, last dimension fastest, `frame` left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrameValues<'a> {
    /// For floats, and integers that are whole.
    Numbers(&'a [f64]),
    /// For integers.
    Integers(&'a [i64]),
    /// For booleans.
    Flags(&'a [bool]),
}

impl FrameValues<'_> {
    /// How many.
    #[must_use]
    pub const fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Integers(values) => values.len(),
            Self::Flags(values) => values.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
