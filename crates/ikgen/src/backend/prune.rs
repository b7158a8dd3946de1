//! Of the numeric kernel a generated file carries what it calls, and nothing else.
//!
//! The kernel's files are formatted, so their items can be told by their lines: an item starts at the margin after an empty line, a
//! method of an `impl` block one step in. An item is kept when its name is a word of a kept item of its module, or of one that imports it.
//!
//! Of its comments about items a generated file carries the first sentences: what is called, not how it was found.

/// The text of modules, each reduced to the items that `code` needs, in the order given; `uses` are the imports of `code`.
pub(super) fn needed(modules: &[(&str, &str)], uses: &str, code: &str) -> Vec<(String, String)> {
    let mut modules: Vec<Module> =
        modules.iter().map(|(name, text)| Module::of(name, &brief(text))).collect();
    // Last the code itself: a module without items.
    modules.push(Module { words: code_of(code), uses: uses.into(), ..Module::of("", "") });
    loop {
        let all: String = modules.iter().map(|module| module.words.as_str()).collect();
        let before = all.len();
        for i in 0..modules.len() {
            for (from, name) in modules[i].imports() {
                let wanted = is_word(&modules[i].words, &name);
                if let Some(module) =
                    modules.iter_mut().find(|m| wanted && m.name == from && !is_word(&m.words, &name))
                {
                    module.words += &format!("{name}\n");
                }
            }
            modules[i].keep(&all);
        }
        if modules.iter().map(|module| module.words.len()).sum::<usize>() == before {
            break;
        }
    }
    modules.iter().filter_map(Module::text).collect()
}

/// The `use` lines of a text, with the names of its other lines alone.
pub(super) fn imports(text: &str, code: &str) -> String {
    text.lines().filter_map(|line| import(line, code)).map(|line| line + "\n").collect()
}

struct Module {
    name: String,
    /// Comments about the whole.
    about: String,
    uses: String,
    items: Vec<Item>,
    /// Code of what is kept, and names that other modules take from this one.
    words: String,
}

struct Item {
    name: String,
    /// Without methods, those of an `impl` block: its first line.
    text: String,
    methods: Vec<Item>,
    kept: bool,
}

impl Module {
    fn of(name: &str, text: &str) -> Self {
        let mut module = Module {
            name: name.into(),
            about: String::new(),
            uses: String::new(),
            items: Vec::new(),
            words: String::new(),
        };
        for chunk in chunks(text, "") {
            if chunk.starts_with("//!") {
                module.about = chunk;
            } else if chunk.starts_with("use ") || chunk.starts_with("pub use ") {
                module.uses += &chunk;
            } else {
                module.items.push(Item::of(chunk));
            }
        }
        module
    }

    /// Names taken from other modules, each after the module's name.
    fn imports(&self) -> Vec<(String, String)> {
        let mut found = Vec::new();
        for line in self.uses.lines() {
            let path = line.trim_start_matches("pub ").trim_start_matches("use ").trim_end_matches(';');
            let Some((path, names)) = path.rsplit_once("::") else { continue };
            let from = path.rsplit("::").next().unwrap_or(path);
            let names = names.trim_matches(['{', '}']).split(", ");
            found.extend(names.map(|name| (from.to_owned(), name.to_owned())));
        }
        found
    }

    /// Keeps the items that are named in this module, and of those the methods that are named anywhere.
    fn keep(&mut self, all: &str) {
        for item in &mut self.items {
            if !item.kept && is_word(&self.words, &item.name) {
                item.kept = true;
                self.words += &code_of(&item.text);
            }
            for method in item.methods.iter_mut().filter(|m| item.kept && !m.kept && is_word(all, &m.name)) {
                method.kept = true;
                self.words += &code_of(&method.text);
            }
        }
    }

    fn text(&self) -> Option<(String, String)> {
        let items: Vec<String> = self.items.iter().filter_map(Item::kept_text).collect();
        if items.is_empty() {
            return None;
        }
        let items = items.join("\n");
        let uses = imports(&self.uses, &self.words);
        let parts = [&self.about, &uses, &items];
        let parts: Vec<&str> = parts.into_iter().map(|p| p.as_str()).filter(|p| !p.is_empty()).collect();
        Some((self.name.clone(), parts.join("\n")))
    }
}

impl Item {
    fn of(text: String) -> Self {
        let code = code_of(&text);
        if let Some(line) = code.lines().find(|line| line.starts_with("impl")) {
            let head = line.trim_end_matches(" {");
            let of = head.rsplit(" for ").next().unwrap_or(head);
            let of = of.trim_start_matches("impl").trim_start();
            // Generic parameters come before the name.
            let of = if of.starts_with('<') { of.split_once("> ").map_or(of, |(_, of)| of) } else { of };
            let start = text.find(line).map_or(0, |at| at + line.len() + 1);
            let body = text[start..].trim_end().trim_end_matches('}');
            let methods = chunks(body, "    ").into_iter().map(Item::of).collect();
            return Item { name: first_word(of), text: text[..start].into(), methods, kept: false };
        }
        let keywords = ["fn ", "const ", "struct ", "enum ", "type ", "static "];
        let name = code.lines().find_map(|line| {
            let line = line.trim_start().trim_start_matches("pub ");
            keywords
                .iter()
                .find_map(|keyword| line.strip_prefix(keyword))
                .map(|rest| first_word(rest.trim_start_matches("fn ")))
        });
        Item { name: name.unwrap_or_default(), text, methods: Vec::new(), kept: false }
    }

    fn kept_text(&self) -> Option<String> {
        if !self.kept {
            return None;
        }
        if !self.text.lines().any(|line| line.starts_with("impl")) {
            return Some(self.text.clone());
        }
        let methods: Vec<&str> = self.methods.iter().filter(|m| m.kept).map(|m| m.text.as_str()).collect();
        (!methods.is_empty()).then(|| format!("{}{}}}\n", self.text, methods.join("\n")))
    }
}

/// The parts of a text that start at this margin after an empty line.
fn chunks(text: &str, margin: &str) -> Vec<String> {
    let mut chunks = vec![String::new()];
    let mut after_empty = false;
    for line in text.lines() {
        if line.is_empty() {
            after_empty = true;
            continue;
        }
        let at_margin = line.strip_prefix(margin).is_some_and(|rest| !rest.starts_with([' ', '}', ')', ']']));
        if after_empty && at_margin {
            chunks.push(String::new());
        } else if after_empty {
            chunks.last_mut().expect("there is one at least").push('\n');
        }
        after_empty = false;
        let chunk = chunks.last_mut().expect("there is one at least");
        chunk.push_str(line);
        chunk.push('\n');
    }
    chunks.retain(|chunk| !chunk.trim().is_empty());
    chunks
}

/// An import reduced to the names that are words of `code`; nothing when none is.
fn import(line: &str, code: &str) -> Option<String> {
    let Some((before, list)) = line.split_once('{') else {
        let name = line.trim_end_matches(';').rsplit("::").next().unwrap_or(line);
        return is_word(code, name).then(|| line.to_owned());
    };
    let list = list.trim_end_matches("};").split(", ");
    let kept: Vec<&str> = list.filter(|name| is_word(code, name)).collect();
    match &kept[..] {
        [] => None,
        [one] => Some(format!("{before}{one};")),
        _ => Some(format!("{before}{{{}}};", kept.join(", "))),
    }
}

/// A text with the first sentence of each of its comments about items.
fn brief(text: &str) -> String {
    let (mut out, mut rest) = (String::new(), false);
    for line in text.lines() {
        let comment = line.trim_start();
        let about = comment.starts_with("///") || comment.starts_with("//!");
        let sentence = if about { line.find(". ").map_or(line, |end| &line[..=end]) } else { line };
        rest &= about;
        if !rest {
            out += sentence;
            out.push('\n');
        }
        rest = about && (rest || comment.len() == 3 || sentence.ends_with('.'));
    }
    out
}

/// A text without its comments.
fn code_of(text: &str) -> String {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    code.map(|line| line.split(" // ").next().unwrap_or(line).to_owned() + "\n").collect()
}

fn first_word(text: &str) -> String {
    text.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect()
}

fn is_word(text: &str, word: &str) -> bool {
    let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    !word.is_empty()
        && text
            .match_indices(word)
            .any(|(at, _)| !text[..at].ends_with(part) && !text[at + word.len()..].starts_with(part))
}

#[cfg(test)]
mod tests {
    use super::needed;

    #[test]
    fn what_is_not_called_is_left_out() {
        let first = "//! About.\n\nuse super::second::{far, near};\n\n/// Not `far`.\npub fn one() -> f64 {\n    let x = near();\n\n    x\n}\n\n\
                     pub fn other() -> f64 {\n    far()\n}\n";
        let second = "pub fn near() -> f64 {\n    Box::new(2.0).twice()\n}\n\npub fn far() {}\n\n/// A box.\npub struct Box(f64);\n\nimpl Box {\n    \
                      pub fn new(x: f64) -> Self {\n        Self(x)\n    }\n\n    /// Twice.\n    pub fn twice(&self) -> f64 {\n        2.0 * self.0\n    }\n\n    \
                      pub fn thrice(&self) {}\n}\n";
        let found = needed(&[("first", first), ("second", second)], "use first::one;\n", "let x = one();");
        let text = |i: usize| found[i].1.as_str();
        assert_eq!(
            text(0),
            "//! About.\n\nuse super::second::near;\n\n/// Not `far`.\npub fn one() -> f64 {\n    let x = near();\n\n    x\n}\n"
        );
        let left = ["far", "thrice"];
        assert!(left.iter().all(|word| !text(1).contains(word)), "{}", text(1));
        assert!(
            text(1).contains("/// A box.\npub struct Box(f64);\n\nimpl Box {\n    pub fn new"),
            "{}",
            text(1)
        );
        assert!(text(1).ends_with("2.0 * self.0\n    }\n}\n"), "{}", text(1));
    }
}
