//! Reads the `coordinates` member, whatever its nesting.
//!
//! The type of a geometry may come after its coordinates. Therefore they are read without knowing it: an array of
//! numbers is a position, an array of positions is a part, and deeper arrays only group parts. Point, line and polygon
//! types differ only in the depth of the parts. What is kept of the depth is which parts lie in one array.

use std::fmt;

use glam::DVec2;
use serde::de::{DeserializeSeed, Deserializer, Error as _, SeqAccess, Visitor};

/// Positions that lie in one array.
#[derive(Default)]
pub(super) struct Part {
    pub points: Vec<DVec2>,
    /// One value per point, NaN for positions without z. Empty if no position has z.
    pub z: Vec<f64>,
    /// Whether it is the last part of an array of parts, such as the rings of a polygon.
    pub ends_group: bool,
}

impl Part {
    fn push(&mut self, position: [f64; 3], has_z: bool) {
        if has_z && self.z.is_empty() {
            self.z.resize(self.points.len(), f64::NAN);
        }
        self.points.push(DVec2::new(position[0], position[1]));
        if has_z || !self.z.is_empty() {
            self.z.push(position[2]);
        }
    }
}

/// Appends the parts of a `coordinates` member.
pub(super) struct Coordinates<'a>(pub &'a mut Vec<Part>);

impl<'de> DeserializeSeed<'de> for Coordinates<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        let mut nest = Nest { parts: self.0, open: false };
        match (&mut nest).deserialize(deserializer)? {
            Element::Number(_) => Err(D::Error::custom("the coordinates are a bare number")),
            _ => Ok(()),
        }
    }
}

/// The kind of an element, known after it is read.
enum Element {
    Number(f64),
    Position,
    Part,
    Deeper,
    /// An empty array or null.
    Nothing,
}

struct Nest<'a> {
    parts: &'a mut Vec<Part>,
    /// Whether the next position belongs to the last part.
    open: bool,
}

impl<'de> DeserializeSeed<'de> for &mut Nest<'_> {
    type Value = Element;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Element, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for &mut Nest<'_> {
    type Value = Element;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or an array in the coordinates")
    }

    fn visit_f64<E>(self, value: f64) -> Result<Element, E> {
        Ok(Element::Number(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Element, E> {
        Ok(Element::Number(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Element, E> {
        Ok(Element::Number(value as f64))
    }

    fn visit_unit<E>(self) -> Result<Element, E> {
        Ok(Element::Nothing)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Element, A::Error> {
        let mut position = [f64::NAN; 3];
        let (mut numbers, mut positions, mut parts, mut deeper) = (0_usize, 0_usize, 0_usize, 0_usize);
        while let Some(level) = seq.next_element_seed(&mut *self)? {
            match level {
                Element::Number(value) => {
                    if let Some(slot) = position.get_mut(numbers) {
                        *slot = value;
                    }
                    numbers += 1;
                }
                Element::Position => positions += 1,
                Element::Part => parts += 1,
                Element::Deeper => deeper += 1,
                Element::Nothing => {}
            }
        }
        match (numbers, positions, parts + deeper) {
            (0, 0, 0) => Ok(Element::Nothing),
            (1, 0, 0) => Err(A::Error::custom("a position has one number; it needs two or three")),
            (_, 0, 0) => {
                if !self.open {
                    self.parts.push(Part::default());
                    self.open = true;
                }
                let part = self.parts.last_mut().expect("a part is open");
                part.push(position, numbers > 2);
                Ok(Element::Position)
            }
            (0, _, 0) => {
                self.open = false;
                Ok(Element::Part)
            }
            (0, 0, _) => {
                if let Some(last) = self.parts.last_mut().filter(|_| parts > 0) {
                    last.ends_group = true;
                }
                Ok(Element::Deeper)
            }
            _ => Err(A::Error::custom("the coordinates mix numbers and arrays")),
        }
    }
}
