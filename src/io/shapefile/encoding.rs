//! The encoding of the text in a `.dbf`.

use encoding_rs::{Encoding, SHIFT_JIS, UTF_8, WINDOWS_1252};

use crate::io::attributes::is_elevation_name;

/// The encoding that a `.cpg` file names, such as `UTF-8`, `1252`, `ANSI 932`, `ISO 88591`.
pub(in crate::io) fn of_label(label: &str) -> Option<&'static Encoding> {
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

/// Guesses the encoding of a file that does not name one: UTF-8 if the field names are valid UTF-8, otherwise an
/// encoding in which a field has a known elevation name, otherwise that of western Europe. Japanese files often do not
/// name their encoding.
pub(super) fn guessed(names: &[Vec<u8>]) -> &'static Encoding {
    if names.iter().all(|name| std::str::from_utf8(name).is_ok()) {
        return UTF_8;
    }
    let is_known = |encoding: &'static Encoding| {
        names.iter().any(|name| {
            let text = encoding.decode_without_bom_handling_and_without_replacement(name);
            text.is_some_and(|text| is_elevation_name(&text))
        })
    };
    if !is_known(WINDOWS_1252) && is_known(SHIFT_JIS) { SHIFT_JIS } else { WINDOWS_1252 }
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
        assert_eq!(guessed(&names(&[b"ID", "標高".as_bytes()])), UTF_8);
        assert_eq!(guessed(&names(&[b"ID", b"\x95\x57\x8d\x82"])), SHIFT_JIS);
        assert_eq!(guessed(&names(&[b"H\xd6HE"])), WINDOWS_1252);
        assert_eq!(guessed(&names(&[b"\xff\xfe"])), WINDOWS_1252);
    }
}
