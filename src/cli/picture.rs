//! The arguments about pictures: `--preview`, and what a map on paper looks like.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::{Arg, Args};
use image::RgbImage;
use tokosen::base::error::Error;
use tokosen::draw::Scene;
use tokosen::draw::paper::{Fonts, Page, Paper, Sheet};
use tokosen::io::StagedOutput;
use tokosen::io::fonts::{font_files, read_font};
use tokosen::io::raster::write_picture;

use super::console::Console;
use super::extensions::check_extension;
use super::failure::Failure;
use super::flags::Flags;

/// A picture of the surface and the lines.
#[derive(Debug, Clone, Args)]
pub struct PictureArgs {
    /// Also draw a picture of the surface and the lines: .png, or a map on paper with lines and text as vectors: .pdf or .svg
    #[arg(long, value_name = "FILE")]
    pub preview: Option<PathBuf>,
    /// Paper of --preview in .pdf or .svg: A4, A3, A2, A1, A0, or width x height in millimetres: 700x500 [default: what --scale needs, or A3]
    #[arg(long, value_name = "SIZE", value_parser = Paper::from_text, requires = "preview", hide_short_help = true)]
    paper: Option<Paper>,
    /// Scale of --preview in .pdf or .svg: 5000 or 1:5000 [default: the largest usual one that fits on the paper]
    #[arg(long, value_name = "1:N", value_parser = scale, requires = "preview", hide_short_help = true)]
    pub scale: Option<f64>,
    /// Title of --preview in .pdf or .svg
    #[arg(long, value_name = "TEXT", requires = "preview", hide_short_help = true)]
    title: Option<String>,
    /// Line below the map in --preview in .pdf or .svg, such as its source and its date
    #[arg(long, value_name = "TEXT", requires = "preview", hide_short_help = true)]
    source: Option<String>,
    /// Font for letters of the title and the source that the usual one does not have, such as Japanese ones: .ttf, .otf or
    /// .ttc [default: one of the system]
    #[arg(long, value_name = "FILE", requires = "preview", hide_short_help = true)]
    pub font: Option<PathBuf>,
}

/// The picture that a run is asked for.
#[derive(Debug, Clone, Copy)]
pub enum Asked<'a> {
    /// None.
    Nothing,
    /// A map.
    Map(&'a PictureArgs),
    /// A map whose lines are written for its scale.
    MapOfLines(&'a PictureArgs),
    /// A map of differences, on paper alone, with the names of two files.
    Differences(&'a PictureArgs, [&'a Path; 2]),
    /// A model in space, in this file.
    Model(Option<&'a Path>),
}

impl<'a> Asked<'a> {
    /// The file of the picture.
    pub fn file(self) -> Option<&'a Path> {
        match self {
            Self::Nothing => None,
            Self::Map(args) | Self::MapOfLines(args) | Self::Differences(args, _) => args.preview.as_deref(),
            Self::Model(path) => path,
        }
    }

    /// The file that is read.
    pub fn font(self) -> Option<&'a Path> {
        match self {
            Self::Map(args) | Self::MapOfLines(args) | Self::Differences(args, _) => args.font.as_deref(),
            Self::Nothing | Self::Model(_) => None,
        }
    }

    /// Opens the picture, if there is one.
    pub fn open(self, flags: &Flags) -> Result<Option<Picture>, Failure> {
        let Some(path) = self.file() else { return Ok(None) };
        match self {
            Self::Map(args) => return args.open(path, flags, &ABOUT_PAPER, "").map(Some),
            Self::Differences(args, files) => {
                check_extension(path, "maps of differences", &["pdf", "svg"])?;
                let names = files.iter().filter_map(|file| file.file_name()).map(OsStr::to_string_lossy);
                return args.open(path, flags, &ABOUT_PAPER, &names.collect::<String>()).map(Some);
            }
            // The scale is that of the lines too.
            Self::MapOfLines(args) => return args.open(path, flags, &ABOUT_PAPER[1..], "").map(Some),
            Self::Nothing | Self::Model(_) => {}
        }
        check_extension(path, "pictures", &["png"])?;
        let staged = StagedOutput::create(path)?;
        Ok(Some(Picture {
            staged,
            kind: Kind::Png,
            page: Page::default(),
            fonts: Fonts::default(),
            about: String::new(),
        }))
    }
}

/// What is drawn.
pub enum Drawing<'a> {
    /// A map.
    Map(Scene<'a>),
    /// A map that is on paper only.
    Sheet(&'a dyn Fn(&Page, &Fonts) -> Result<Sheet, Error>),
    /// A picture that is ready.
    Image(RgbImage),
}

/// The flags about maps on paper.
const ABOUT_PAPER: [&str; 5] = ["--scale", "--paper", "--title", "--source", "--font"];

/// `--scale` where lines are written for it, with or without a picture.
pub fn scale_of_lines(help: &'static str) -> Arg {
    Arg::new("scale").long("scale").value_name("1:N").value_parser(scale).help(help)
}

/// The number of a scale.
fn scale(text: &str) -> Result<f64, String> {
    let number = text.trim().strip_prefix("1:").unwrap_or(text).replace([' ', '_'], "");
    match number.parse::<f64>() {
        Ok(scale) if scale >= 1.0 && scale.is_finite() => Ok(scale),
        _ => Err("it must be a number such as 5000 or 1:5000".into()),
    }
}

impl PictureArgs {
    /// Opens the picture in a file. `of_paper` are the flags that apply to paper alone, and `names` what stands on it beside the
    /// title and the source.
    fn open(&self, path: &Path, flags: &Flags, of_paper: &[&'static str], names: &str) -> Result<Picture, Failure> {
        check_extension(path, "pictures", &["png", "pdf", "svg"])?;
        let is = |extension: &str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension));
        let kind = match () {
            () if is("pdf") => Kind::Pdf,
            () if is("svg") => Kind::Svg,
            () => Kind::Png,
        };
        if let Some(flag) = flags.first(of_paper).filter(|_| kind == Kind::Png) {
            return Err(Failure::Usage(format!("{flag} applies to maps on paper: --preview FILE.pdf or FILE.svg")));
        }
        let fonts = if kind == Kind::Png { Fonts::default() } else { self.fonts(names)? };
        let page =
            Page { paper: self.paper, scale: self.scale, title: self.title.clone(), source: self.source.clone() };
        Ok(Picture { staged: StagedOutput::create(path)?, kind, page, fonts, about: String::new() })
    }

    /// The fonts that have all letters of the title, the source and these names.
    fn fonts(&self, names: &str) -> Result<Fonts, Failure> {
        let usual = Fonts::default();
        let texts: String =
            [&self.title, &self.source].into_iter().flatten().map(String::as_str).chain([names]).collect();
        if let Some(path) = &self.font {
            let fonts = usual.with(read_font(path)?).map_err(|error| error.in_file(path))?;
            return match fonts.lacks(&texts) {
                Some(letter) => {
                    Err(Failure::Usage(format!("the font {} does not have the letter {letter}", path.display())))
                }
                None => Ok(fonts),
            };
        }
        let Some(letter) = usual.lacks(&texts) else { return Ok(usual) };
        let found = font_files().filter_map(|path| usual.clone().with(read_font(&path).ok()?).ok());
        found.into_iter().find(|fonts| fonts.lacks(&texts).is_none()).ok_or_else(|| {
            Failure::Usage(format!("no font was found that has the letter {letter}: name one with --font FILE"))
        })
    }
}

/// How a picture is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Png,
    Pdf,
    Svg,
}

/// A picture that is still to be drawn.
pub struct Picture {
    staged: StagedOutput,
    kind: Kind,
    page: Page,
    fonts: Fonts,
    /// What is said about it.
    about: String,
}

impl Picture {
    /// Draws it, still under its temporary name.
    pub fn draw(&mut self, drawing: &Drawing<'_>, console: &Console) -> Result<(), Failure> {
        let drawn = console.step("drawing", || self.write(drawing));
        self.about = drawn.map_err(|error| self.staged.with_final_name(error))?;
        Ok(())
    }

    /// Writes the file, and returns what is said about it.
    fn write(&self, drawing: &Drawing<'_>) -> Result<String, Error> {
        let path = self.staged.path();
        let sheet = match drawing {
            Drawing::Image(image) => return write_picture(&path, image).map(|()| String::new()),
            Drawing::Map(scene) if self.kind == Kind::Png => {
                return write_picture(&path, &scene.image()?).map(|()| String::new());
            }
            Drawing::Map(scene) => scene.sheet(&self.page, &self.fonts)?,
            Drawing::Sheet(sheet) => sheet(&self.page, &self.fonts)?,
        };
        let bytes = match self.kind {
            Kind::Svg => sheet.svg(&self.fonts)?.into_bytes(),
            _ => sheet.pdf(&self.fonts)?,
        };
        std::fs::write(&path, bytes).map_err(|e| Error::io("write", &path, e))?;
        let [width, height] = sheet.size();
        let scale = sheet.scale().map_or_else(String::new, |scale| format!(", 1:{scale}"));
        Ok(format!(" ({width} x {height} mm{scale})"))
    }

    /// Puts it in its place, and says so.
    pub fn commit(self, console: &Console) -> Result<(), Failure> {
        console.say(&self.put()?);
        Ok(())
    }

    /// Puts it in its place. Gives what is to be said about it.
    pub fn put(self) -> Result<String, Failure> {
        Ok(format!("written    {}{}", self.staged.commit()?.display(), self.about))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_numbers() {
        assert_eq!(["5000", "1:5000", "1:25 000"].map(scale), [Ok(5000.0), Ok(5000.0), Ok(25_000.0)]);
        for wrong in ["", "0", "-5", "1:x", "nan", "1:inf", "1/5000"] {
            assert!(scale(wrong).is_err(), "{wrong}");
        }
    }
}
