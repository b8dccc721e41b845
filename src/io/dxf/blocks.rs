//! The blocks of a drawing: groups of entities that references (`INSERT`) place in the drawing, once or many times.

use std::collections::{BTreeMap, HashMap};

use glam::DVec3;

use super::copies::Copies;
use super::entity::{Entity, Polyline, read_polyline};
use super::groups::GroupReader;
use super::placement::Placement;
use tokosen_core::base::error::{Error, Result};

/// The largest depth of blocks in blocks.
const MAX_DEPTH: usize = 32;
/// Copies of blocks may add this many entities and vertices to any drawing.
const ROOM: usize = 1 << 20;
/// The same for each byte of a larger drawing.
const ROOM_PER_BYTE: usize = 16;

/// Flags of a block whose content is in another drawing.
const IS_EXTERNAL: i64 = 4 | 8;
/// The layer of entities in a block that take the layer of the reference.
const INHERITED: &[u8] = b"0";

/// An entity, and the line of a `POLYLINE`.
pub(super) struct Item<'a> {
    pub kind: &'a [u8],
    pub entity: Entity<'a>,
    /// The vertices that follow a `POLYLINE`. `None` for another entity, and if it is a mesh.
    pub line: Option<Polyline>,
}

impl<'a> Item<'a> {
    /// Reads an entity of this kind with what follows it. `None` if it belongs to the entity before it.
    pub fn read(kind: &'a [u8], groups: &mut GroupReader<'a>) -> Result<Option<Self>> {
        let entity = Entity::read(groups)?;
        let line = match kind {
            b"POLYLINE" => read_polyline(&entity, groups)?,
            b"VERTEX" | b"SEQEND" | b"ATTRIB" => return Ok(None),
            _ => None,
        };
        Ok(Some(Self { kind, entity, line }))
    }
}

#[derive(Default)]
struct Block<'a> {
    base: DVec3,
    is_external: bool,
    items: Vec<Item<'a>>,
}

/// The blocks of a drawing, by their names in capitals.
#[derive(Default)]
pub(super) struct Blocks<'a>(HashMap<Vec<u8>, Block<'a>>);

/// An entity of a block, where a reference puts it.
pub(super) struct Placed<'b, 'a> {
    pub item: &'b Item<'a>,
    pub placement: Placement,
    /// The name of its layer, in the encoding of the file.
    pub layer: &'a [u8],
}

/// References that could not be followed, with their number and the reason.
pub(super) type Missing = BTreeMap<String, u64>;

impl<'a> Blocks<'a> {
    /// Reads the section of blocks.
    pub fn read(&mut self, groups: &mut GroupReader<'a>) -> Result<()> {
        let mut open: Option<(Vec<u8>, Block<'a>)> = None;
        loop {
            let group = groups.must("blocks")?;
            if group.begins("EOF") {
                groups.put_back(group);
            } else if group.code != 0 {
                continue;
            }
            match group.word() {
                b"BLOCK" => {
                    let head = Entity::read(groups)?;
                    let name = head.find(2).map_or(&[][..], |name| name.word()).to_ascii_uppercase();
                    let is_external = head.flags(70)? & IS_EXTERNAL != 0;
                    open = Some((name, Block { base: head.point(10)?, is_external, items: Vec::new() }));
                }
                b"ENDBLK" | b"ENDSEC" | b"EOF" => {
                    // Of two blocks of one name, the first counts, as in CAD programs.
                    if let Some((name, block)) = open.take() {
                        self.0.entry(name).or_insert(block);
                    }
                    if group.word() != b"ENDBLK" {
                        return Ok(());
                    }
                }
                kind => {
                    let item = Item::read(kind, groups)?;
                    if let Some((_, block)) = &mut open {
                        block.items.extend(item);
                    }
                }
            }
        }
    }

    /// The room for the copies in a drawing of this many bytes.
    pub fn room(bytes: usize) -> usize {
        bytes.saturating_mul(ROOM_PER_BYTE).max(ROOM)
    }

    /// Calls `visit` with every entity that a reference places, also by blocks in its block.
    ///
    /// # Errors
    /// The copies need more than `room`, the blocks are nested too deep, or as `visit`.
    pub fn follow<'b>(
        &'b self,
        insert: &'b Entity<'a>,
        room: &mut usize,
        missing: &mut Missing,
        visit: &mut dyn FnMut(Placed<'b, 'a>) -> Result<()>,
    ) -> Result<()> {
        let mut walk = Walk { blocks: self, open: Vec::new(), room, missing, visit };
        walk.insert(insert, layer_of(insert), &Placement::IDENTITY)
    }
}

/// The name of an entity's layer.
pub(super) fn layer_of<'a>(entity: &Entity<'a>) -> &'a [u8] {
    entity.find(8).map_or(INHERITED, |group| group.word())
}

struct Walk<'w, 'b, 'a> {
    blocks: &'b Blocks<'a>,
    /// The names of the blocks around.
    open: Vec<Vec<u8>>,
    room: &'w mut usize,
    missing: &'w mut Missing,
    visit: &'w mut dyn FnMut(Placed<'b, 'a>) -> Result<()>,
}

impl<'b, 'a> Walk<'_, 'b, 'a> {
    fn insert(&mut self, insert: &'b Entity<'a>, layer: &'a [u8], around: &Placement) -> Result<()> {
        let name = insert.find(2).map_or(&[][..], |name| name.word());
        let key = name.to_ascii_uppercase();
        let mut refuse = |why: &str| {
            *self.missing.entry(format!("{:?} {why}", String::from_utf8_lossy(name))).or_default() += 1;
            Ok(())
        };
        let Some(block) = self.blocks.0.get(&key) else { return refuse("is not in the drawing") };
        if block.is_external && block.items.is_empty() {
            return refuse("is another drawing");
        }
        if self.open.contains(&key) {
            return refuse("contains itself");
        }
        if self.open.len() >= MAX_DEPTH {
            let message = "its blocks are nested too deep; explode them in the program that drew them";
            return Err(Error::file(insert.path(), message));
        }
        self.open.push(key);
        let copies = Copies::of(insert, block.base)?;
        let [columns, rows] = copies.counts;
        // Copies of an empty block take time as well.
        self.spend(usize::try_from(columns.saturating_mul(rows)).unwrap_or(usize::MAX), insert)?;
        for (column, row) in (0..columns).flat_map(|column| (0..rows).map(move |row| (column, row))) {
            let placement = around.of(&copies.at(column, row));
            for item in &block.items {
                self.spend(item.entity.len() + item.line.as_ref().map_or(0, |line| line.points.len()), insert)?;
                let own = layer_of(&item.entity);
                let layer = if own == INHERITED { layer } else { own };
                match item.kind {
                    b"INSERT" => self.insert(&item.entity, layer, &placement)?,
                    _ => (self.visit)(Placed { item, placement, layer })?,
                }
            }
        }
        self.open.pop();
        Ok(())
    }

    fn spend(&mut self, cost: usize, insert: &Entity<'a>) -> Result<()> {
        match self.room.checked_sub(cost) {
            Some(rest) => *self.room = rest,
            None => {
                let message = "its blocks are repeated so often that they would fill the memory; check the rows and columns \
                               of its references to blocks (INSERT), or explode those with contours alone";
                return Err(Error::file(insert.path(), message));
            }
        }
        Ok(())
    }
}
