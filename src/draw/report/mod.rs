//! The report of a comparison: sentences ([`remarks`]), tables ([`groups`]) and an HTML page ([`comparison_page`]).
//!
//! The page is one HTML file that needs no other file. Charts are SVG, drawn by `plotters`; pictures are embedded PNG;
//! there is no script. The layout suits a phone, a desktop screen and paper.

mod charts;
mod maps;
mod page;
mod profile;
mod sheet;
mod survey;
mod table;
mod text;
mod view;
mod words;

pub use page::{ComparisonPage, comparison_page, difference_map};
pub use sheet::comparison_sheet;
pub use table::{Group, Row, decimals_for, groups};
pub use text::table;
pub use words::{HeightSource, remarks};
