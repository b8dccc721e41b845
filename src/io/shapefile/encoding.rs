//! The encoding of the text in a `.dbf`.

use encoding_rs::{
    BIG5, EUC_JP, EUC_KR, Encoding, GBK, IBM866, ISO_8859_2, KOI8_R, SHIFT_JIS, UTF_8, WINDOWS_874, WINDOWS_1250,
    WINDOWS_1251, WINDOWS_1252, WINDOWS_1253, WINDOWS_1254, WINDOWS_1257,
};

use crate::attributes::is_elevation_name;

/// The encoding that a `.cpg` file names, such as `UTF-8`, `1252`, `ANSI 932`, `ISO 88591`.
pub(crate) fn of_label(label: &str) -> Option<&'static Encoding> {
    let label = label.trim().trim_start_matches('\u{feff}').to_ascii_lowercase();
    if let Some(encoding) = Encoding::for_label(label.as_bytes()) {
        return Some(encoding);
    }
    let digits: String = label.chars().filter(char::is_ascii_digit).collect();
    if let Some(part) = digits.strip_prefix("8859") {
        return Encoding::for_label(format!("iso-8859-{part}").as_bytes());
    }
    of_code_page(digits.parse().ok()?)
}

/// The encoding of the header's language byte. `None` if the byte is unset or unknown.
pub(super) fn of_language_byte(byte: u8) -> Option<&'static Encoding> {
    let code_page = match byte {
        0x13 | 0x7b => 932,
        0x4d | 0x7a => 936,
        0x4e | 0x79 => 949,
        0x4f | 0x78 => 950,
        0x26 | 0x65 => 866,
        0x50 | 0x7c => 874,
        0xc8 => 1250,
        0xc9 => 1251,
        0x03 | 0x59 => 1252,
        0xcb => 1253,
        0xca => 1254,
        0x7d => 1255,
        0x7e => 1256,
        0xcc => 1257,
        _ => return None,
    };
    of_code_page(code_page)
}

fn of_code_page(number: u32) -> Option<&'static Encoding> {
    let label = match number {
        65001 => "utf-8".to_owned(),
        932 => "shift_jis".to_owned(),
        936 => "gbk".to_owned(),
        949 => "euc-kr".to_owned(),
        950 => "big5".to_owned(),
        866 => "ibm866".to_owned(),
        20932 | 51932 => "euc-jp".to_owned(),
        54936 => "gb18030".to_owned(),
        874 | 1250..=1258 => format!("windows-{number}"),
        _ => return None,
    };
    Encoding::for_label(label.as_bytes())
}

/// The encodings in which names of fields are looked for, if a file does not name its own: that of western Europe, then
/// those of Japan, Korea, China, Taiwan, central Europe, and those of Cyrillic and other scripts.
const CANDIDATES: [&Encoding; 15] = [
    WINDOWS_1252,
    SHIFT_JIS,
    EUC_JP,
    EUC_KR,
    GBK,
    BIG5,
    WINDOWS_1250,
    WINDOWS_1251,
    IBM866,
    KOI8_R,
    WINDOWS_1253,
    WINDOWS_1254,
    WINDOWS_1257,
    WINDOWS_874,
    ISO_8859_2,
];

/// An encoding, and whether that is sure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Guess {
    pub encoding: &'static Encoding,
    /// Whether the names are UTF-8 or one of them is known in this encoding.
    pub is_sure: bool,
}

/// Guesses the encoding of a text by the names of its fields: the first in which a field has a known elevation name or the
/// one that the user `named`. `said` is what the file seems to say. It is tried first, then UTF-8. If no name is known, it
/// is left, otherwise UTF-8 if all names are valid UTF-8. Files of all countries often do not name their encoding, and some
/// programs set the header's byte to their own.
pub(crate) fn guessed(names: &[Vec<u8>], named: Option<&str>, said: Option<&'static Encoding>) -> Guess {
    let named = named.map(str::to_lowercase);
    let is_known = |encoding: &&'static Encoding| {
        // A name in ASCII is the same in all of them, and decides nothing.
        names.iter().filter(|name| !name.is_ascii()).any(|name| {
            let text = encoding.decode_without_bom_handling_and_without_replacement(name);
            text.is_some_and(|text| is_elevation_name(&text) || named.as_ref() == Some(&text.trim().to_lowercase()))
        })
    };
    let is_utf_8 = names.iter().all(|name| std::str::from_utf8(name).is_ok());
    match said.into_iter().chain([UTF_8]).chain(CANDIDATES).find(is_known) {
        Some(encoding) => Guess { encoding, is_sure: true },
        None if is_utf_8 => Guess { encoding: said.unwrap_or(UTF_8), is_sure: true },
        None => Guess { encoding: said.unwrap_or(WINDOWS_1252), is_sure: said.is_some() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels() {
        for (label, name) in [
            ("UTF-8", "UTF-8"),
            ("65001", "UTF-8"),
            ("\u{feff}utf8\r\n", "UTF-8"),
            ("SHIFT_JIS", "Shift_JIS"),
            ("932", "Shift_JIS"),
            ("CP932", "Shift_JIS"),
            ("ANSI 932", "Shift_JIS"),
            ("SJIS", "Shift_JIS"),
            ("1252", "windows-1252"),
            ("ISO-8859-1", "windows-1252"),
            ("88591", "windows-1252"),
            ("ISO 8859-2", "ISO-8859-2"),
            ("EUC-JP", "EUC-JP"),
        ] {
            assert_eq!(of_label(label).map(Encoding::name), Some(name), "{label}");
        }
        assert_eq!(of_label("klingon"), None);
        assert_eq!(of_label(""), None);
    }

    #[test]
    fn guesses() {
        let names = |text: &[&[u8]]| text.iter().map(|name| name.to_vec()).collect::<Vec<_>>();
        let guess = |text: &[&[u8]], named: Option<&str>| {
            let Guess { encoding, is_sure } = guessed(&names(text), named, None);
            (encoding.name(), is_sure)
        };
        assert_eq!(guess(&[b"ID", "標高".as_bytes()], None), ("UTF-8", true));
        assert_eq!(guess(&[b"ID", b"\x95\x57\x8d\x82"], None), ("Shift_JIS", true));
        assert_eq!(guess(&[b"H\xd6HE"], None), ("windows-1252", true));
        assert_eq!(guess(&[b"\xff\xfe", b"ELEV"], None), ("windows-1252", false));
        for (name, encoding) in [
            ("등고수치", EUC_KR),
            ("높이", EUC_KR),
            ("高程", GBK),
            ("标高", GBK),
            ("標高", EUC_JP),
            ("等高線", BIG5),
            ("高程", BIG5),
            ("wysokość", WINDOWS_1250),
            ("VÝŠKA", WINDOWS_1250),
            ("высота", WINDOWS_1251),
            ("ОТМЕТКА", WINDOWS_1251),
            ("Высота", IBM866),
            ("высота", KOI8_R),
        ] {
            let (bytes, used, is_lost) = encoding.encode(name);
            assert!(used == encoding && !is_lost, "{name}");
            let Guess { encoding: found, is_sure } = guessed(&names(&[b"ID", &bytes]), None, None);
            assert_eq!(found.decode(&bytes).0, name, "{name} in {} was taken for {}", encoding.name(), found.name());
            assert!(is_sure, "{name}");
        }
        // Names that are not known here, but named by the user.
        let own = EUC_KR.encode("산높이").0.into_owned();
        assert_eq!(guess(&[&own], None), ("windows-1252", false));
        assert_eq!(guess(&[&own], Some("산높이")), ("EUC-KR", true));
        assert_eq!(guess(&[b"\xe2\xfb\xf1"], Some("ВЫС")), ("windows-1251", true));
    }

    #[test]
    fn the_headers_byte_gives_way_to_a_known_name() {
        let korean = vec![EUC_KR.encode("등고수치").0.into_owned()];
        let said = |names: &[Vec<u8>], encoding| guessed(names, None, Some(encoding)).encoding;
        assert_eq!(said(&korean, WINDOWS_1252), EUC_KR);
        assert_eq!(said(&[b"\x80\x81".to_vec()], SHIFT_JIS), SHIFT_JIS);
        assert_eq!(said(&[b"ELEV".to_vec()], SHIFT_JIS), SHIFT_JIS);
    }
}
