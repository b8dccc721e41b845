//! What a comparison found, for people: sentences and tables ([`remarks`], [`groups`]) and a page of its own
//! ([`comparison_page`]).
//!
//! The page is one file of HTML that needs nothing else: charts are drawn by `plotters` as SVG, pictures are PNG inside the
//! page, there is no script. It is laid out for a phone, a desk and paper.

mod charts;
mod maps;
mod page;
mod profile;
mod table;
mod told;
mod words;

pub use page::{ComparisonPage, comparison_page};
pub use table::{Group, Row, decimals_for, groups};
pub use told::{page, sentences, table};
pub use words::{HeightSource, remarks};
