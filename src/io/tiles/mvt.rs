//! A vector tile with one layer of lines: the messages of the Mapbox Vector Tile specification 2.1.

use quick_protobuf::Writer;

/// The version of the specification in the file.
const VERSION: u32 = 2;
/// The type of a feature of lines.
const LINES: i32 = 2;
/// Commands of a geometry.
const MOVE_TO: u32 = 1;
const LINE_TO: u32 = 2;

/// Keys of fields: their number and how they are stored.
const fn varint(field: u32) -> u32 {
    field << 3
}
const fn bytes(field: u32) -> u32 {
    (field << 3) | 2
}
const fn double(field: u32) -> u32 {
    (field << 3) | 1
}

/// The value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Text(String),
    Real(f64),
    Whole(i64),
    Bool(bool),
}

/// Lines that share their attributes.
#[derive(Debug, Clone, Default)]
pub(super) struct Feature<'a> {
    pub attributes: &'a [(&'static str, Value)],
    geometry: Vec<u32>,
    /// The last vertex.
    last: [i64; 2],
}

impl<'a> Feature<'a> {
    pub fn new(attributes: &'a [(&'static str, Value)]) -> Self {
        Self { attributes, geometry: Vec::new(), last: [0; 2] }
    }

    /// Adds a line of two vertices or more, in steps of the grid from the tile's upper left corner.
    pub fn add(&mut self, mut line: impl ExactSizeIterator<Item = [i64; 2]>) {
        let count = line.len() as u32;
        let Some(first) = line.next() else { return };
        self.geometry.push(MOVE_TO | (1 << 3));
        self.step_to(first);
        self.geometry.push(LINE_TO | ((count - 1) << 3));
        line.for_each(|p| self.step_to(p));
    }

    fn step_to(&mut self, p: [i64; 2]) {
        // Tiles are small: steps fit into 32 bits.
        let steps = [p[0] - self.last[0], p[1] - self.last[1]].map(|step| step as i32);
        self.geometry.extend(steps.map(|step| ((step << 1) ^ (step >> 31)) as u32));
        self.last = p;
    }
}

/// The bytes of a tile with one layer.
pub(super) fn tile(name: &str, extent: u32, features: &[Feature<'_>]) -> quick_protobuf::Result<Vec<u8>> {
    let (mut keys, mut values): (Vec<&str>, Vec<&Value>) = (Vec::new(), Vec::new());
    let mut layer = Vec::new();
    let mut out = Writer::new(&mut layer);
    out.write_with_tag(varint(15), |out| out.write_uint32(VERSION))?;
    out.write_with_tag(bytes(1), |out| out.write_string(name))?;
    for feature in features {
        let mut tags = Vec::with_capacity(2 * feature.attributes.len());
        for (key, value) in feature.attributes {
            tags.push(number(&mut keys, key));
            tags.push(number(&mut values, value));
        }
        let message = message(&tags, &feature.geometry)?;
        out.write_with_tag(bytes(2), |out| out.write_bytes(&message))?;
    }
    for key in keys {
        out.write_with_tag(bytes(3), |out| out.write_string(key))?;
    }
    for value in values {
        let value = value_message(value)?;
        out.write_with_tag(bytes(4), |out| out.write_bytes(&value))?;
    }
    out.write_with_tag(varint(5), |out| out.write_uint32(extent))?;
    let mut tile = Vec::with_capacity(layer.len() + 8);
    Writer::new(&mut tile).write_with_tag(bytes(3), |out| out.write_bytes(&layer))?;
    Ok(tile)
}

/// The number of an item in a list, where it is added if it is new.
fn number<T: PartialEq>(list: &mut Vec<T>, item: T) -> u32 {
    let known = list.iter().position(|known| *known == item);
    known.unwrap_or_else(|| {
        list.push(item);
        list.len() - 1
    }) as u32
}

fn message(tags: &[u32], geometry: &[u32]) -> quick_protobuf::Result<Vec<u8>> {
    let size = |number: &u32| quick_protobuf::sizeofs::sizeof_varint(u64::from(*number));
    let mut message = Vec::new();
    let mut out = Writer::new(&mut message);
    out.write_packed_with_tag(bytes(2), tags, |out, number| out.write_uint32(*number), &size)?;
    out.write_with_tag(varint(3), |out| out.write_enum(LINES))?;
    out.write_packed_with_tag(bytes(4), geometry, |out, number| out.write_uint32(*number), &size)?;
    Ok(message)
}

fn value_message(value: &Value) -> quick_protobuf::Result<Vec<u8>> {
    let mut message = Vec::new();
    let mut out = Writer::new(&mut message);
    match value {
        Value::Text(text) => out.write_with_tag(bytes(1), |out| out.write_string(text))?,
        Value::Real(number) => out.write_with_tag(double(3), |out| out.write_double(*number))?,
        Value::Whole(number) => out.write_with_tag(varint(6), |out| out.write_sint64(*number))?,
        Value::Bool(is_true) => out.write_with_tag(varint(7), |out| out.write_bool(*is_true))?,
    }
    Ok(message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bytes_are_those_of_the_specification() {
        // The example of a line in the specification, section 4.3.5.3: (2,2), (2,10), (10,10).
        let mut feature = Feature::new(&[]);
        feature.add([[2, 2], [2, 10], [10, 10]].into_iter());
        assert_eq!(feature.geometry, [9, 4, 4, 18, 0, 16, 16, 0]);
        // Its second line, (1,1), (3,5), begins at the end of the first.
        feature.add([[1, 1], [3, 5]].into_iter());
        assert_eq!(feature.geometry[8..], [9, 17, 17, 10, 4, 8]);
        let attributes = [("ele", Value::Whole(-5)), ("t", Value::Text("a".into())), ("idx", Value::Bool(true))];
        let mut feature = Feature::new(&attributes);
        feature.add([[0, 0], [1, 0]].into_iter());
        let bytes = tile("c", 4096, &[feature]).unwrap();
        let expected: &[u8] = &[
            0x1a, 54, 0x78, 2, 0x0a, 1, b'c', // layer, version, name
            0x12, 18, 0x12, 6, 0, 0, 1, 1, 2, 2, 0x18, 2, 0x22, 6, 9, 0, 0, 10, 2, 0, // feature
            0x1a, 3, b'e', b'l', b'e', 0x1a, 1, b't', 0x1a, 3, b'i', b'd', b'x', // keys
            0x22, 2, 0x30, 9, 0x22, 3, 0x0a, 1, b'a', 0x22, 2, 0x38, 1, // values
            0x28, 0x80, 0x20, // extent
        ];
        assert_eq!(bytes, expected);
    }
}
