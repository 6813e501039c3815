//! Default classes: attribute values for elements of a class.

use super::xml::{Element, Value, children, malformed, unsupported};
use crate::error::{Result, quoted};
use std::collections::BTreeMap;

/// Deepest nesting of classes, which bounds the cost of a lookup.
const DEEPEST: usize = 32;

/// Kinds of elements whose defaults are read.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Geom,
    Joint,
}

/// All classes; the first is the outermost.
pub(super) struct Classes<'a> {
    list: Vec<Class<'a>>,
    by_name: BTreeMap<&'a str, usize>,
}

/// Defaults stated by a class itself; other defaults are those of its parent.
#[derive(Default)]
struct Class<'a> {
    parent: Option<usize>,
    depth: usize,
    geom: BTreeMap<&'a str, Value<'a>>,
    joint: BTreeMap<&'a str, Value<'a>>,
}

/// The class that applies to all elements.
pub(super) const MAIN: usize = 0;

impl<'a> Classes<'a> {
    /// Reads the classes of a document from all its `<default>` elements.
    pub fn read(root: Element<'a>) -> Result<Self> {
        let mut classes = Self { list: vec![Class::default()], by_name: BTreeMap::from([("main", MAIN)]) };
        for (_, element) in children(root).filter(|(tag, _)| *tag == "default") {
            if let Some(name) = element.attribute("class") {
                classes.by_name.insert(name, MAIN);
            }
            classes.read_nested(element)?;
        }
        Ok(classes)
    }

    /// Reads an outermost `<default>` and its descendants. Uses an explicit stack instead of recursion, so that a
    /// deep file cannot overflow the call stack.
    fn read_nested(&mut self, outermost: Element<'a>) -> Result<()> {
        let mut open = vec![(outermost, MAIN)];
        while let Some((element, index)) = open.pop() {
            for (tag, child) in children(element) {
                let class = &mut self.list[index];
                let entries = child.attributes().map(|a| (a.name(), Value::new(child, a)));
                match tag {
                    "geom" => class.geom.extend(entries),
                    "joint" => class.joint.extend(entries),
                    "default" => open.push((child, self.add(child, index)?)),
                    // Defaults of elements that this module does not read.
                    _ => {}
                }
            }
        }
        Ok(())
    }

    fn add(&mut self, element: Element<'a>, parent: usize) -> Result<usize> {
        let name = element.attribute("class").ok_or_else(|| malformed(element, "`class` is missing"))?;
        let depth = self.list[parent].depth + 1;
        if depth > DEEPEST {
            return Err(unsupported(element, format!("classes nested more than {DEEPEST} deep")));
        }
        let index = self.list.len();
        if self.by_name.insert(name, index).is_some() {
            return Err(malformed(element, format!("two classes are named {}", quoted(name))));
        }
        self.list.push(Class { parent: Some(parent), depth, ..Class::default() });
        Ok(index)
    }

    /// Returns the class that an attribute names, or `otherwise` without the attribute.
    pub fn named_by(&self, element: Element<'a>, key: &str, otherwise: usize) -> Result<usize> {
        let Some(value) = Value::of(element, key) else { return Ok(otherwise) };
        let found = self.by_name.get(value.text()).copied();
        found.ok_or_else(|| value.malformed(format!("no class {}", quoted(value.text()))))
    }

    /// Returns an element with the defaults of its class: its own class, or the one inherited from the bodies around
    /// it.
    pub fn merge(&self, element: Element<'a>, kind: Kind, inherited: usize) -> Result<Merged<'a, '_>> {
        let class = self.named_by(element, "class", inherited)?;
        Ok(Merged { element, kind, class, classes: self })
    }
}

/// An element with the defaults of its class.
#[derive(Clone, Copy)]
pub(super) struct Merged<'a, 'c> {
    pub element: Element<'a>,
    kind: Kind,
    class: usize,
    classes: &'c Classes<'a>,
}

impl<'a> Merged<'a, '_> {
    /// Returns the attribute of the element, else that of the innermost class that has it.
    pub fn get(&self, key: &str) -> Option<Value<'a>> {
        Value::of(self.element, key).or_else(|| self.defaults().find_map(|table| table.get(key).copied()))
    }

    /// Returns the attribute of the element whose name is in `keys`, else that of the innermost class with one.
    ///
    /// # Errors
    /// If two of them are at the same level, because only one can apply.
    pub fn get_one(&self, keys: &[&str]) -> Result<Option<Value<'a>>> {
        let of_element = keys.iter().filter_map(|key| Value::of(self.element, key)).collect();
        let mut levels = core::iter::once(of_element)
            .chain(self.defaults().map(|t| keys.iter().filter_map(|key| t.get(key).copied()).collect()));
        let first: Vec<Value<'a>> = levels.find(|found: &Vec<_>| !found.is_empty()).unwrap_or_default();
        match first[..] {
            [] => Ok(None),
            [one] => Ok(Some(one)),
            [one, two, ..] => Err(two.malformed(format!("`{}` sets the same", one.key()))),
        }
    }

    /// Iterates over the attributes of the class and of the classes around it, innermost first.
    fn defaults(&self) -> impl Iterator<Item = &BTreeMap<&'a str, Value<'a>>> {
        let classes = &self.classes.list;
        core::iter::successors(Some(&classes[self.class]), |class| {
            class.parent.map(|parent| &classes[parent])
        })
        .map(|class| match self.kind {
            Kind::Geom => &class.geom,
            Kind::Joint => &class.joint,
        })
    }
}
