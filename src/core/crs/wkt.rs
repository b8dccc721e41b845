//! Well-known text as a tree.
//!
//! One reader serves WKT 1, WKT 2 and Esri's flavour, because all three are keywords with bracketed arguments. Text
//! that is not of that shape gives `None`; no text makes the reader panic or recurse.

use std::ops::Range;

/// Largest depth of nested brackets. The deepest systems in use nest about ten levels.
const MAX_DEPTH: usize = 64;

/// A keyword with its arguments.
#[derive(Debug)]
pub(super) struct Node {
    /// In capitals.
    pub keyword: String,
    /// Where it stands in the text: the bytes from the keyword to the closing bracket.
    pub span: Range<usize>,
    args: Vec<Arg>,
}

#[derive(Debug)]
enum Arg {
    /// In quotation marks.
    Text(String),
    /// A number or a bare word.
    Word(String),
    Node(Node),
}

/// Reads a text that is one keyword with arguments.
pub(super) fn parse(text: &str) -> Option<Node> {
    parse_first(text).filter(|node| text[node.span.end..].trim().is_empty())
}

/// Reads a text that is two keywords with arguments, separated by a comma: how Esri's programs write a horizontal and a
/// vertical system. The places of the second count from the start of its text, which is given too.
pub(super) fn parse_pair(text: &str) -> Option<(Node, Node, &str)> {
    let first = parse_first(text)?;
    let rest = text[first.span.end..].trim_start().strip_prefix(',')?.trim();
    Some((first, parse(rest)?, rest))
}

/// Reads the keyword with arguments at the start of a text.
fn parse_first(text: &str) -> Option<Node> {
    let mut open: Vec<Node> = Vec::new();
    // Start of the word that the next bracket or comma ends.
    let mut word = text.len() - text.trim_start().trim_start_matches('\u{feff}').len();
    let mut chars = text.char_indices().peekable();
    while let Some((at, c)) = chars.next() {
        match c {
            '[' | '(' => {
                let keyword = text[word..at].trim();
                if keyword.is_empty() || open.len() == MAX_DEPTH {
                    return None;
                }
                let start = at - text[word..at].trim_start().len();
                open.push(Node { keyword: keyword.to_ascii_uppercase(), span: start..at, args: Vec::new() });
            }
            ']' | ')' => {
                let mut node = open.pop()?;
                push_word(&text[word..at], &mut node);
                node.span.end = at + 1;
                match open.last_mut() {
                    Some(parent) => parent.args.push(Arg::Node(node)),
                    None => return Some(node),
                }
            }
            ',' => push_word(&text[word..at], open.last_mut()?),
            '"' => {
                let parent = open.last_mut()?;
                let mut quoted = String::new();
                let end = loop {
                    match chars.next()? {
                        // A doubled quotation mark stands for one inside the text.
                        (_, '"') if chars.peek().is_some_and(|(_, c)| *c == '"') => {
                            quoted.extend(chars.next().map(|(_, c)| c));
                        }
                        (end, '"') => break end,
                        (_, other) => quoted.push(other),
                    }
                };
                parent.args.push(Arg::Text(quoted));
                word = end + 1;
                continue;
            }
            _ => continue,
        }
        word = at + 1;
    }
    None
}

/// Adds a number or a bare word, unless there is nothing but space.
fn push_word(word: &str, node: &mut Node) {
    let bare = word.trim();
    if !bare.is_empty() {
        node.args.push(Arg::Word(bare.to_owned()));
    }
}

impl Node {
    /// The first argument in quotation marks.
    pub fn name(&self) -> Option<&str> {
        self.args.iter().find_map(|arg| match arg {
            Arg::Text(text) => Some(text.as_str()),
            _ => None,
        })
    }

    /// The arguments that are themselves keywords with arguments.
    pub fn nodes(&self) -> impl DoubleEndedIterator<Item = &Node> {
        self.args.iter().filter_map(|arg| match arg {
            Arg::Node(node) => Some(node),
            _ => None,
        })
    }

    /// The first argument of one of these keywords.
    pub fn child(&self, keywords: &[&str]) -> Option<&Node> {
        self.nodes().find(|node| keywords.contains(&node.keyword.as_str()))
    }

    /// The numbers among the arguments.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        self.args.iter().filter_map(|arg| match arg {
            Arg::Word(word) => word.parse().ok(),
            _ => None,
        })
    }

    /// Authority and code from the last `AUTHORITY` or `ID` of this node itself.
    pub fn authority(&self) -> Option<(&str, u32)> {
        let node = self.nodes().rfind(|node| matches!(node.keyword.as_str(), "AUTHORITY" | "ID"))?;
        let code = node.args.get(1).and_then(|arg| match arg {
            Arg::Text(text) | Arg::Word(text) => text.trim().parse().ok(),
            Arg::Node(_) => None,
        })?;
        Some((node.name()?, code))
    }

    /// This node and all below it, in the order of the text.
    pub fn all(&self) -> Vec<&Node> {
        let (mut found, mut waiting) = (Vec::new(), vec![self]);
        while let Some(node) = waiting.pop() {
            found.push(node);
            waiting.extend(node.nodes().rev());
        }
        found
    }

    /// The system itself, without a transformation that is bound to it.
    pub fn unbound(&self) -> &Node {
        let source = if self.keyword == "BOUNDCRS" { self.child(&["SOURCECRS"]) } else { None };
        source.and_then(|source| source.nodes().next()).unwrap_or(self)
    }

    /// The horizontal part of a compound or bound system; the node itself if it is neither.
    pub fn horizontal(&self) -> &Node {
        let mut node = self;
        loop {
            let inner = match node.keyword.as_str() {
                "COMPD_CS" | "COMPOUNDCRS" => node.nodes().find(|part| part.is_system()),
                "BOUNDCRS" => Some(node.unbound()),
                _ => None,
            };
            match inner {
                Some(part) if !std::ptr::eq(part, node) => node = part,
                _ => return node,
            }
        }
    }

    /// The vertical part of a compound system, if it is one.
    pub fn vertical(&self) -> Option<&Node> {
        let node = self.unbound();
        if !matches!(node.keyword.as_str(), "COMPD_CS" | "COMPOUNDCRS") {
            return None;
        }
        let is_vertical =
            |part: &&Node| matches!(part.keyword.as_str(), "VERT_CS" | "VERTCS" | "VERTCRS" | "VERTICALCRS");
        node.nodes().map(Node::unbound).find(is_vertical)
    }

    fn is_system(&self) -> bool {
        self.keyword.ends_with("CRS") || self.keyword.ends_with("CS") && self.keyword != "CS"
    }

    /// Whether this horizontal system has plane coordinates by a projection.
    pub fn is_projected(&self) -> bool {
        matches!(self.keyword.as_str(), "PROJCS" | "PROJCRS" | "PROJECTEDCRS")
    }

    /// Whether this horizontal system has plane coordinates without a place on the Earth.
    pub fn is_local(&self) -> bool {
        matches!(self.keyword.as_str(), "LOCAL_CS" | "ENGCRS" | "ENGINEERINGCRS")
    }

    /// Whether this horizontal system has degrees for coordinates.
    pub fn is_geographic(&self) -> bool {
        match self.keyword.as_str() {
            "GEOGCS" | "GEOGCRS" | "GEOGRAPHICCRS" => true,
            // Latitude and longitude, or earth-centred metres: the `CS` node says which.
            "GEODCRS" | "GEODETICCRS" => self.child(&["CS"]).is_some_and(
                |cs| matches!(cs.args.first(), Some(Arg::Word(kind)) if kind.eq_ignore_ascii_case("ellipsoidal")),
            ),
            _ => false,
        }
    }

    /// Name and metres of the unit of this system, unless it is geographic.
    pub fn length_unit(&self) -> Option<(&str, f64)> {
        if self.is_geographic() {
            return None;
        }
        let unit = self
            .child(&["UNIT", "LENGTHUNIT"])
            .or_else(|| self.child(&["AXIS"]).and_then(|axis| axis.child(&["LENGTHUNIT", "UNIT"])))?;
        Some((unit.name()?, unit.numbers().next().filter(|metres| metres.is_finite() && *metres > 0.0)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_quotes_and_numbers() {
        let node = parse(" GEOGCS ( \"say \"\"hi\"\"\" , UNIT[ \"degree\", 1.5e-2 ] ,x) ").unwrap();
        assert_eq!((node.keyword.as_str(), node.name()), ("GEOGCS", Some("say \"hi\"")));
        assert_eq!(node.child(&["UNIT"]).unwrap().numbers().collect::<Vec<_>>(), [0.015]);
    }

    #[test]
    fn every_node_knows_where_it_stands() {
        let text = "\u{feff} A[\"é[\" , B [1,C[2]],\n D(\"x\"\"\",E[]) ] ";
        let node = parse(text).unwrap();
        let spans: Vec<&str> = node.all().iter().map(|n| &text[n.span.clone()]).collect();
        assert_eq!(
            spans,
            [text.trim().trim_start_matches('\u{feff}').trim(), "B [1,C[2]]", "C[2]", "D(\"x\"\"\",E[])", "E[]"]
        );
    }

    #[test]
    fn garbage_is_no_tree() {
        let deep = "A[".repeat(100_000);
        let nested = format!("{}{}", "A[".repeat(1000), "]".repeat(1000));
        for text in
            ["", "PROJCS", "PROJCS[", "[\"x\"]", "PROJCS[\"x", "]", ",", "\"", "A[1]]", "A[1] B", &deep, &nested]
        {
            assert!(parse(text).is_none(), "{:.40}", text);
        }
    }

    #[test]
    fn no_prefix_and_no_changed_byte_panics() {
        let text = crs_definitions::EPSG_5972.wkt;
        for end in 0..text.len() {
            let node = parse(&text[..end]);
            assert!(node.is_none());
            for c in ['[', ']', '"', ',', 'é', '\0'] {
                let changed = format!("{}{c}{}", &text[..end], &text[end + 1..]);
                let crs = crate::crs::Crs::from_wkt(&changed);
                let _ = (crs.is_geographic(), crs.name(), crs.length_unit(), crs.wkt1().is_some());
            }
        }
    }
}
