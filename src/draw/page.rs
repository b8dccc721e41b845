//! A page in one HTML file: styles, libraries, scripts and data are in it, so that it opens without a network.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde_json::Value;

/// What a page consists of.
pub(crate) struct Page<'a> {
    pub title: &'a str,
    /// What the browser may load.
    pub policy: &'a str,
    pub styles: &'a [&'a str],
    /// The first elements of the body.
    pub body: Markup,
    /// The licences of the libraries.
    pub licences: &'a str,
    /// What the scripts read from the element `data`.
    pub data: &'a Value,
    pub libraries: &'a [&'a str],
    /// The page's own scripts. They share their names with each other, and with nothing else.
    pub scripts: &'a [&'a str],
}

impl Page<'_> {
    /// The page as HTML.
    pub fn html(&self) -> String {
        // Nothing in it ends the element that holds it.
        let data = self.data.to_string().replace('<', "\\u003c");
        let script = |text: &str| html! { script { (PreEscaped(text)) } };
        html! {
            (DOCTYPE)
            html {
                head {
                    meta charset="utf-8";
                    meta name="generator" content="tokosen";
                    meta http-equiv="Content-Security-Policy" content=(self.policy);
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (self.title) }
                    // Browsers ask the server for an icon if a page names none.
                    link rel="icon" href="data:,";
                    @for style in self.styles { style { (PreEscaped(style)) } }
                }
                body {
                    (self.body)
                    noscript { "This page needs JavaScript. / このページにはJavaScriptが必要です。" }
                    script type="text/plain" id="licences" { (PreEscaped(self.licences)) }
                    script type="application/json" id="data" { (PreEscaped(data)) }
                    @for library in self.libraries { (script(library)) }
                    (script(&format!("(() => {{\n\"use strict\";\n{}}})();", self.scripts.concat())))
                }
            }
        }
        .into_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_end_their_place() {
        let page = |text: &str| {
            let data = serde_json::json!({ "name": text, "list": [text] });
            let body = html! { p { (text) } };
            let page = Page {
                title: text,
                policy: "",
                styles: &[],
                body,
                licences: "",
                data: &data,
                libraries: &[],
                scripts: &[],
            };
            page.html()
        };
        let evil = "</script><script>alert(1)</script><!--";
        let (plain, page) = (page(""), page(evil));
        for end in ["</script", "<script", "<!--"] {
            assert_eq!(page.matches(end).count(), plain.matches(end).count(), "{end}");
        }
        // What the page reads is what was meant.
        let data = page.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next()).unwrap();
        let read: Value = serde_json::from_str(data).unwrap();
        assert_eq!((&read["name"], &read["list"][0]), (&evil.into(), &evil.into()));
    }
}
