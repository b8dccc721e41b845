//! Areas in colour for pictures of sub-domains and of triangles.

use super::patches::{Patch, PatchClass, Patches};
use tokosen_core::skeleton::Skeleton;
use tokosen_core::subdomains::{Landform, LandformClass};
use tokosen_core::tin::{Tin, TriangleKind};

/// Sub-domains, coloured by class: warm for high ground, cool for low.
pub fn landform_patches(forms: &[Landform], tin: &Tin) -> Patches {
    let class = |class: LandformClass| PatchClass { name: class.name().to_owned(), color: color(class) };
    let rings = |form: &Landform| form.rings.iter().map(|ring| ring.points(tin)).collect();
    let number = |form: &Landform| LandformClass::ALL.iter().position(|class| *class == form.class);
    let areas = forms.iter().filter_map(|form| Some(Patch { class: number(form)?, rings: rings(form) }));
    Patches { classes: LandformClass::ALL.map(class).to_vec(), areas: areas.collect() }
}

fn color(class: LandformClass) -> [u8; 3] {
    match class {
        LandformClass::Peak => [196, 52, 40],
        LandformClass::Bottom => [36, 58, 150],
        LandformClass::Tableland => [232, 148, 66],
        LandformClass::Basin => [72, 148, 206],
        LandformClass::RidgePeak => [156, 52, 128],
        LandformClass::Valley => [38, 150, 132],
        LandformClass::Slope => [176, 190, 110],
        LandformClass::Water => [150, 200, 235],
        LandformClass::Branching => [238, 212, 84],
    }
}

/// Triangles, coloured by kind.
pub fn triangle_patches(tin: &Tin, skeleton: &Skeleton) -> Patches {
    let class = |(name, color): (&str, [u8; 3])| PatchClass { name: name.to_owned(), color };
    let classes = [
        ("terminal", [226, 124, 60]),
        ("sleeve", [240, 222, 130]),
        ("junction", [70, 110, 190]),
        ("eliminated", [150, 150, 150]),
    ];
    let number = |t: u32| match skeleton.kinds[t as usize] {
        TriangleKind::Terminal => Some(0),
        TriangleKind::Sleeve => Some(1),
        TriangleKind::Junction if skeleton.elimination.eliminated[t as usize] => Some(3),
        TriangleKind::Junction => Some(2),
        TriangleKind::Isolated | TriangleKind::Outside => None,
    };
    let ring = |t: u32| [0, 1, 2, 0].map(|i| tin.point(tin.triangles[t as usize][i]).truncate()).to_vec();
    let areas = (0..tin.len() as u32).filter_map(|t| Some(Patch { class: number(t)?, rings: vec![ring(t)] }));
    Patches { classes: classes.map(class).to_vec(), areas: areas.collect() }
}
