//! A page of text, tables and pictures, written as Markdown and as HTML.

use std::fmt::Write as _; // writing to a string cannot fail

/// A part of the page. Text is plain: no markup of either language passes through.
pub enum Block {
    /// A heading with its level.
    Heading(u8, String),
    /// A paragraph.
    Text(String),
    /// A table: names of columns, and rows.
    Table(Vec<&'static str>, Vec<Vec<String>>),
    /// File and description.
    Picture(String, String),
    /// An SVG that is part of the page, and its description.
    Drawing(String, String),
    /// Lines of output as they were printed.
    Output(String),
    /// Files with what they hold.
    Files(Vec<(String, String)>),
}

/// A page with its title.
pub struct Page {
    /// Its title.
    pub title: String,
    /// Its parts.
    pub blocks: Vec<Block>,
}

impl Page {
    /// The page as Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = format!("# {}\n", cell(&self.title));
        for block in &self.blocks {
            text.push('\n');
            match block {
                Block::Heading(level, words) => {
                    text.push_str(&"#".repeat(usize::from(*level)));
                    let _ = writeln!(text, " {}", cell(words));
                }
                Block::Text(words) => {
                    let _ = writeln!(text, "{}", cell(words));
                }
                Block::Table(header, rows) => {
                    let _ = writeln!(
                        text,
                        "| {} |",
                        header
                            .iter()
                            .map(|name| cell(name))
                            .collect::<Vec<_>>()
                            .join(" | ")
                    );
                    let _ = writeln!(text, "|{}", " --- |".repeat(header.len()));
                    for row in rows {
                        let cells: Vec<String> = row.iter().map(|c| cell(c)).collect();
                        let _ = writeln!(text, "| {} |", cells.join(" | "));
                    }
                }
                Block::Picture(file, about) => {
                    let _ = writeln!(text, "![{}]({file})", cell(about));
                }
                Block::Drawing(_, about) => {
                    let _ = writeln!(text, "*{}*", cell(about));
                }
                Block::Output(lines) => {
                    let _ = writeln!(text, "```text\n{}\n```", lines.trim_end());
                }
                Block::Files(list) => {
                    for (file, about) in list {
                        let _ = writeln!(text, "- [{file}]({file}): {}", cell(about));
                    }
                }
            }
        }
        text
    }

    /// The page as HTML.
    #[must_use]
    pub fn html(&self) -> String {
        let title = escaped(&self.title);
        let mut text = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
        );
        for block in &self.blocks {
            match block {
                Block::Heading(level, words) => {
                    let _ = writeln!(text, "<h{level}>{}</h{level}>", escaped(words));
                }
                Block::Text(words) => {
                    let _ = writeln!(text, "<p>{}</p>", escaped(words));
                }
                Block::Table(header, rows) => {
                    text.push_str("<table>\n<tr>");
                    for name in header {
                        let _ = write!(text, "<th>{}</th>", escaped(name));
                    }
                    text.push_str("</tr>\n");
                    for row in rows {
                        text.push_str("<tr>");
                        for cell in row {
                            let _ = write!(text, "<td>{}</td>", escaped(cell));
                        }
                        text.push_str("</tr>\n");
                    }
                    text.push_str("</table>\n");
                }
                Block::Picture(file, about) => {
                    let about = escaped(about);
                    let _ = writeln!(
                        text,
                        "<figure><img src=\"{file}\" alt=\"{about}\"><figcaption>{about}</figcaption></figure>"
                    );
                }
                Block::Drawing(svg, about) => {
                    let (about, source) = (escaped(about), data_address(svg));
                    let _ = writeln!(
                        text,
                        "<figure><img src=\"{source}\" alt=\"{about}\"><figcaption>{about}</figcaption></figure>"
                    );
                }
                Block::Output(lines) => {
                    let lines = lines.trim_end().lines().map(grouser_figure::escaped);
                    let lines: Vec<String> = lines.collect();
                    let _ = writeln!(text, "<pre>{}</pre>", lines.join("\n"));
                }
                Block::Files(list) => {
                    text.push_str("<ul>\n");
                    for (file, about) in list {
                        let about = escaped(about);
                        let _ = writeln!(text, "<li><a href=\"{file}\">{file}</a>: {about}</li>");
                    }
                    text.push_str("</ul>\n");
                }
            }
        }
        text.push_str("</body>\n</html>\n");
        text
    }
}

const STYLE: &str = "body { max-width: 60rem; margin: 2rem auto; padding: 0 1rem; font: 1rem/1.5 serif; color: #1a1a1e; }\n\
h1, h2 { font-weight: 600; line-height: 1.2; }\n\
table { border-collapse: collapse; width: 100%; }\n\
th, td { text-align: left; vertical-align: top; padding: 0.3rem 0.8rem 0.3rem 0; border-bottom: 1px solid #d8d8dc; }\n\
img { max-width: 100%; }\n\
figcaption { color: #55555c; }\n\
pre { overflow-x: auto; font-size: 0.8rem; line-height: 1.35; background: #f4f4f5; padding: 0.6rem; }\n";

/// An SVG as an address of its own. Its characters apart from these few may stand in an attribute.
fn data_address(svg: &str) -> String {
    let mut address = String::from("data:image/svg+xml,");
    for letter in svg.chars() {
        match letter {
            '%' | '#' | '"' | '<' | '>' | '&' => {
                let _ = write!(address, "%{:02X}", u32::from(letter));
            }
            '\n' => address.push(' '),
            _ => address.push(letter),
        }
    }
    address
}

fn escaped(text: &str) -> String {
    let plain = grouser_figure::escaped(text);
    // Text between backticks is code.
    let mut parts = plain.split('`');
    let mut out = parts.next().unwrap_or_default().to_owned();
    for (index, part) in parts.enumerate() {
        out.push_str(if index % 2 == 0 { "<code>" } else { "</code>" });
        out.push_str(part);
    }
    out
}

/// Text that Markdown shows unchanged; text between backticks is code.
fn cell(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut code = false;
    for letter in text.chars() {
        code ^= letter == '`';
        if letter == '|' || (!code && matches!(letter, '_' | '*' | '<' | '[' | '\\')) {
            out.push('\\');
        }
        out.push(letter);
    }
    out
}
