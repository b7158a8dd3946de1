//! `${...}` and `$(...)` in text.

use std::path::{Path, PathBuf};

use serde_saphyr::options::DuplicateKeyPolicy;

use super::evaluate::{Names, evaluate};
use super::expand::Expander;
use super::scope::Property;
use super::syntax;
use super::value::Value;
use crate::urdf::{normal, package_folder};

/// Longest text that one attribute may grow to.
const LONGEST: usize = 1 << 20;

impl Expander<'_> {
    /// The value of `text`: what its only expression gives, or the text with all expressions put in.
    pub(super) fn value_of(&mut self, text: &str) -> Result<Value, String> {
        let top = self.scopes.len();
        self.value_in(text, top)
    }

    /// `text` with its expressions put in.
    pub(super) fn text_of(&mut self, text: &str) -> Result<String, String> {
        Ok(self.value_of(text)?.to_string())
    }

    /// The value of `text` as seen from the outermost `top` scopes.
    fn value_in(&mut self, text: &str, top: usize) -> Result<Value, String> {
        let mut out = String::new();
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            out.push_str(&rest[..at]);
            let after = &rest[at + 1..];
            // A doubled dollar before a bracket stands for one dollar.
            if let Some(escaped) = after.strip_prefix('$').filter(|e| e.starts_with(['{', '('])) {
                out.push('$');
                out.push_str(&escaped[..1]);
                rest = &escaped[1..];
                continue;
            }
            let close = match after.chars().next() {
                Some('{') => '}',
                Some('(') => ')',
                _ => {
                    out.push('$');
                    rest = after;
                    continue;
                }
            };
            let length = closing(after, close)
                .ok_or_else(|| format!("`${}` is never closed with `{close}`", &after[..1]))?;
            let inner = &after[1..length];
            let value = match close {
                // Commands inside of an expression are carried out first, even in its quotes.
                '}' if inner.contains("$(") => {
                    let inner = self.value_in(inner, top)?.to_string();
                    evaluate(&syntax::parse(&inner)?, &mut View { expander: self, top })?
                }
                '}' => evaluate(&syntax::parse(inner)?, &mut View { expander: self, top })?,
                _ => self.command(inner, top)?,
            };
            if at == 0 && out.is_empty() && rest.len() == text.len() && after.len() == length + 1 {
                return Ok(value);
            }
            out.push_str(&value.to_string());
            if out.len() > LONGEST {
                return Err("the text grows without end".to_owned());
            }
            rest = &after[length + 1..];
        }
        out.push_str(rest);
        self.spend(out.len())?;
        Ok(Value::Text(out))
    }

    /// `$(...)`.
    fn command(&mut self, inner: &str, top: usize) -> Result<Value, String> {
        let inner = self.value_in(inner, top)?.to_string();
        let (name, rest) = inner.trim().split_once(char::is_whitespace).unwrap_or((inner.trim(), ""));
        let rest = rest.trim();
        match name {
            "arg" => self.argument(rest),
            "find" => {
                let file = self.file().to_path_buf();
                let main = self.main_file().to_path_buf();
                let find = |from: &Path| package_folder(self.system, self.packages, from, rest);
                match find(&file).or_else(|| find(&main)) {
                    Some(folder) => Ok(self.folder(folder, Some(rest))),
                    None => Err(format!(
                        "package `{rest}` is not known: say where it is by `--package {rest}=FOLDER`, or under [packages]"
                    )),
                }
            }
            "dirname" => {
                let folder = self.file().parent().unwrap_or(Path::new("")).to_path_buf();
                Ok(self.folder(folder, None))
            }
            "eval" => evaluate(&syntax::parse(rest)?, &mut View { expander: self, top }),
            "optenv" => {
                let default = rest.split_once(char::is_whitespace).map_or("", |(_, default)| default.trim());
                Ok(Value::from_text(default))
            }
            "env" => {
                Err("`$(env ...)` is refused: a description must not depend on the environment".to_owned())
            }
            _ => Err(format!("`$({name} ...)` is not known")),
        }
    }

    /// A folder as text, remembered as one that stands for itself wherever that text is used.
    fn folder(&mut self, folder: PathBuf, package: Option<&str>) -> Value {
        if folder.as_os_str().is_empty() {
            return Value::Text(".".to_owned());
        }
        let text = folder.display().to_string();
        self.folders.insert(folder, package.map(str::to_owned));
        Value::Text(text)
    }

    /// A reference to a file as it is understood from the description: those into a package name the package.
    pub(super) fn as_reference(&self, name: String) -> String {
        let path = Path::new(name.strip_prefix("file://").unwrap_or(&name));
        let inside = |(folder, package): (&PathBuf, &Option<String>)| {
            Some((package.as_ref()?.clone(), path.strip_prefix(folder).ok()?.display().to_string()))
        };
        match self.folders.iter().rev().find_map(inside) {
            Some((package, rest)) => format!("package://{package}/{rest}"),
            None => name,
        }
    }

    /// The value of an argument.
    pub(super) fn argument(&mut self, name: &str) -> Result<Value, String> {
        let value = self.arguments.get(name);
        value
            .map(|text| Value::from_text(text))
            .ok_or_else(|| format!("argument `{name}` is neither given nor declared: give it by `--argument {name}=VALUE`, or under [arguments]"))
    }

    /// The property of this name as seen from the outermost `top` scopes.
    fn property_in(&mut self, name: &str, top: usize) -> Result<Option<Value>, String> {
        let Some(at) = self.scopes[..top].iter().rposition(|s| s.properties.contains_key(name)) else {
            return Ok(None);
        };
        let Some(slot) = self.scopes[at].properties.get_mut(name) else { return Ok(None) };
        match std::mem::replace(slot, Property::Pending) {
            Property::Pending => Err(format!("property `{name}` is defined by itself")),
            Property::Value(value) => {
                *slot = Property::Value(value.clone());
                Ok(Some(value))
            }
            Property::Written(written) => {
                let value = self.deeper(|e| e.value_in(&written, at + 1));
                // A failure leaves the text, so that each use reports it.
                let slot = self.scopes[at].properties.entry(name.to_owned()).or_insert(Property::Pending);
                match value {
                    Ok(value) => {
                        let value = match value {
                            Value::Text(text) => Value::from_text(&text),
                            other => other,
                        };
                        *slot = Property::Value(value.clone());
                        Ok(Some(value))
                    }
                    Err(error) => {
                        *slot = Property::Written(written);
                        Err(error)
                    }
                }
            }
        }
    }

    /// The path that `name`, written in the current file, means.
    pub(super) fn relative(&self, name: &str) -> PathBuf {
        let name = name.strip_prefix("file://").unwrap_or(name);
        if let Some(reference) = name.strip_prefix("package://") {
            let (package, rest) = reference.split_once('/').unwrap_or((reference, ""));
            if let Some(folder) = package_folder(self.system, self.packages, self.file(), package) {
                return normal(&folder.join(rest));
            }
        }
        if self.folders.keys().any(|folder| Path::new(name).starts_with(folder)) {
            return normal(Path::new(name));
        }
        normal(&self.file().parent().unwrap_or(Path::new("")).join(name))
    }
}

/// Where the bracket that opens `text` is closed: brackets in quotes do not count, nested ones do.
fn closing(text: &str, close: char) -> Option<usize> {
    let open = text.chars().next()?;
    let mut quote = None;
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        match quote {
            Some(q) if c == q => quote = None,
            Some(_) => {}
            None if (c == '\'' || c == '"') && close == '}' => quote = Some(c),
            None if c == open => depth += 1,
            None if c == close => {
                depth -= 1;
                if depth == 0 {
                    return Some(at);
                }
            }
            None => {}
        }
    }
    None
}

/// What an expression sees of an expansion.
struct View<'e, 'a> {
    expander: &'e mut Expander<'a>,
    top: usize,
}

impl Names for View<'_, '_> {
    fn property(&mut self, name: &str) -> Result<Option<Value>, String> {
        let value = self.expander.property_in(name, self.top)?;
        self.spend(value.as_ref().map_or(0, Value::size))?;
        Ok(value)
    }

    fn spend(&mut self, size: usize) -> Result<(), String> {
        self.expander.spend(size)
    }

    fn argument(&mut self, name: &str) -> Result<Value, String> {
        self.expander.argument(name)
    }

    fn load_yaml(&mut self, path: &str) -> Result<Value, String> {
        let path = self.expander.relative(path);
        let bytes = self.expander.system.read(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let text = String::from_utf8(bytes).map_err(|_| format!("{} is not UTF-8 text", path.display()))?;
        // ROS's reader keeps the last of equal keys, and published descriptions rely on it.
        let options = serde_saphyr::options! { duplicate_keys: DuplicateKeyPolicy::LastWins };
        let text = with_angles_resolved(&text);
        let json: Result<serde_json::Value, _> = serde_saphyr::from_str_with_options(&text, options);
        json.map(|json| Value::from_json(&json)).map_err(|error| {
            let message = error.without_snippet().to_string();
            format!("{}: {}", path.display(), message.lines().next().unwrap_or_default())
        })
    }
}

/// YAML with ROS's tags `!degrees X` and `!radians X` replaced by the angle in radians.
fn with_angles_resolved(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find("!degrees").into_iter().chain(rest.find("!radians")).min() {
        let (tag, after) = rest[at..].split_at("!degrees".len());
        let word = after.trim_start();
        let length = word.find(|c: char| c.is_whitespace() || ",]}#".contains(c)).unwrap_or(word.len());
        out.push_str(&rest[..at]);
        match word[..length].parse::<f64>() {
            Ok(angle) if tag == "!degrees" => {
                out.push_str(&(angle * (std::f64::consts::PI / 180.0)).to_string())
            }
            _ => out.push_str(&word[..length]),
        }
        rest = &word[length..];
    }
    out.push_str(rest);
    out
}
