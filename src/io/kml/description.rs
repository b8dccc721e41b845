//! Attributes in the description of a placemark: the rows of an HTML table with a name and a value each.

/// The rows of two cells. Empty if the text is no HTML table.
pub(super) fn rows(text: &str) -> Vec<(String, String)> {
    let lower = text.to_ascii_lowercase();
    if !lower.contains("<td") {
        return Vec::new();
    }
    let mut rows = Vec::new();
    let mut cells: Vec<String> = Vec::new();
    let (mut in_cell, mut at) = (false, 0);
    let mut end_row = |cells: &mut Vec<String>| {
        if let [name, value] = &cells[..]
            && !name.is_empty()
        {
            rows.push((name.clone(), value.clone()));
        }
        cells.clear();
    };
    while let Some(open) = text[at..].find('<').map(|found| at + found) {
        if in_cell && let Some(cell) = cells.last_mut() {
            cell.push_str(&text[at..open]);
        }
        let close = text[open..].find('>').map_or(text.len(), |found| open + found + 1);
        let tag = lower[open + 1..close].trim_end_matches('>');
        let name: String = tag.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '/').collect();
        match name.as_str() {
            "td" | "th" => {
                cells.push(String::new());
                in_cell = true;
            }
            "/td" | "/th" => in_cell = false,
            "tr" | "/tr" => {
                end_row(&mut cells);
                in_cell = false;
            }
            _ => {}
        }
        at = close;
    }
    rows.into_iter().map(|(name, value)| (plain(&name), plain(&value))).collect()
}

/// The text without the entities of HTML and the spaces around it.
fn plain(text: &str) -> String {
    let text = text.replace("&nbsp;", " ").replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
    text.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_two_cells_are_attributes() {
        let html = "<html><body><table><tr><td colspan=\"2\">Contour 7</td></tr><tr bgcolor=\"#D4E4F3\"><TD>ELEV</TD>\n<td> 125.5 \
                    </td></tr><tr><td>Kind &amp; <b>type</b></td><td></td></tr></table>";
        let found = rows(html);
        assert_eq!(found, [("ELEV".into(), "125.5".into()), ("Kind & type".into(), String::new())]);
        for none in ["125", "<b>125</b>", "<td", "<table><td>1</td></table>", ""] {
            assert_eq!(rows(none), [], "{none}");
        }
    }
}
