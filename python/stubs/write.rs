//! Write: the text of the stub file.

use std::fmt::Write;

use syn::parse::{ParseStream, Parser};
use syn::{Ident, LitStr, Token};

use crate::source::{Argument, Class, Function, Passing, Property, Source};
use crate::types::{Types, entries};

const HEAD: &str = r#""""The compiled core. Made by python/stubs at each build."""

import pathlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, TypeAlias, Unpack, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _keywords as k
"#;

/// Properties that Python adds to a class, from the core's tables.
const BASES: [(&str, &str); 2] = [("Array", "k.Radiating"), ("Scene", "k.Numbers")];

/// Types of `**name`.
const OTHERS: [(&str, &str); 3] = [("parts", "k.Parts"), ("keys", "k.Keys"), ("changes", "k.Changes")];

/// Parameters that decide which of two types a function returns: the first without them, the second with them.
const DECIDING: [&str; 2] = ["out", "points"];

/// A method that is a function of the package.
struct Attached {
    class: String,
    name: String,
    home: String,
    function: String,
}

/// An argument in Python.
#[derive(Clone)]
struct Parameter {
    name: String,
    kind: String,
    passing: Passing,
    default: Option<String>,
}

struct Writer<'a> {
    types: Types<'a>,
    attached: Vec<Attached>,
    /// The types of a solver's name, and the keywords that go with it.
    solvers: Vec<(String, String)>,
    text: String,
}

/// Returns the stub file.
pub(crate) fn stub(source: &Source, toolbox: &str, keywords: &str) -> String {
    let solvers = keywords.lines().filter_map(|line| line.strip_prefix("class Setting")?.split_once("(Setting, "));
    let solvers = solvers.map(|(name, _)| match name {
        "Every" => ("None".into(), name.into()),
        _ => (format!("Literal[\"{}\"]", name.to_lowercase()), name.into()),
    });
    let solvers = solvers.chain([("str".into(), String::new())]).collect();
    let mut writer = Writer { types: Types::of(source), attached: attached(toolbox), solvers, text: HEAD.into() };
    writer.whole(source);
    writer.text
}

impl Writer<'_> {
    fn whole(&mut self, source: &Source) {
        for Attached { home, function, .. } in &self.attached {
            writeln!(self.text, "from .{home} import {function} as {}", local(home, function)).unwrap();
        }
        let names =
            source.exported.iter().map(|name| source.functions.get(name).map_or(name, |function| &function.name));
        let mut names: Vec<_> = names.chain(source.constants.iter().map(|constant| &constant.name)).collect();
        names.sort();
        write!(self.text, "\n__all__ = {names:?}\n\n").unwrap();
        self.text += "_Parts: TypeAlias = k.Parts\n\n";
        for Property { name, kind, doc } in &source.constants {
            let kind = self.types.result(Some(kind), "", "");
            writeln!(self.text, "{name}: Final[{kind}]\n\"\"\"{doc}\"\"\"").unwrap();
        }
        for name in &source.exported {
            if let Some(class) = source.classes.get(name) {
                self.class(name, class);
            } else if let Some(exception) = source.exceptions.get(name) {
                write!(self.text, "\nclass {name}({}):", exception.base).unwrap();
                self.doc(&exception.doc, 1);
                for (name, kind) in entries(&exception.doc, "Attributes") {
                    writeln!(self.text, "    {name}: {}", kind.unwrap_or_else(|| "Any".into())).unwrap();
                }
            } else {
                self.function(&source.functions[name], "");
            }
        }
    }

    fn class(&mut self, name: &str, class: &Class) {
        let base = BASES.iter().find(|(known, _)| *known == name).map(|(_, base)| format!("({base})"));
        write!(self.text, "\n@final\nclass {name}{}:", base.unwrap_or_default()).unwrap();
        self.doc(&class.doc.replace("{medium}\n{parts}", "**keys").replace("{parts}", "**parts"), 1);
        for property in &class.properties {
            let kind = self.types.result(Some(&property.kind), "", name);
            write!(self.text, "    @property\n    def {}(self) -> {kind}:", property.name).unwrap();
            self.doc(&property.doc, 2);
        }
        for method in &class.methods {
            match method.name.as_str() {
                "_new" => {
                    let new = Function { name: "__new__".into(), doc: class.doc.clone(), ..method.clone() };
                    self.function(&new, name);
                }
                "_restore" | "__reduce__" | "__repr__" | "__eq__" => {}
                _ => self.function(method, name),
            }
        }
        let is = |word: &str| class.options.split(',').any(|option| option.trim() == word);
        if is("eq") || class.methods.iter().any(|method| method.name == "__eq__") {
            self.text += "    def __eq__(self, other: object, /) -> bool: ...\n";
        }
        if is("hash") {
            self.text += "    def __hash__(self) -> int: ...\n";
        }
        for Attached { name, home, function, .. } in self.attached.iter().filter(|one| one.class == name) {
            let function = local(home, function);
            writeln!(self.text, "    {name} = {function}").unwrap();
        }
    }

    /// Writes a function or a method, with overloads where its arguments decide.
    fn function(&mut self, function: &Function, class: &str) {
        let parameter = |argument: &Argument| {
            let mut kind = match OTHERS.iter().find(|(name, _)| *name == argument.name) {
                Some((_, kind)) if argument.passing == Passing::Others => format!("Unpack[{kind}]"),
                _ => self.types.argument(&argument.name, &argument.kind, &function.doc, class),
            };
            if argument.default.as_deref() == Some("None") && kind != "Any" {
                kind += " | None";
            }
            let default = argument.default.as_deref().map(python);
            Parameter { name: argument.name.clone(), kind, passing: argument.passing, default }
        };
        // `**others` are mistyped keywords, which the function refuses.
        let parameters: Vec<_> = function.arguments.iter().filter(|one| one.name != "others").map(parameter).collect();
        let returns = match function.name.as_str() {
            "__new__" => class.into(),
            _ => self.types.result(function.returns.as_ref(), &function.doc, class),
        };
        let overloads = self.overloads(&parameters, &returns);
        let indent = if class.is_empty() { "" } else { "    " };
        let first = match (class, function.name.as_str()) {
            ("", _) => None,
            (_, "__new__") => Some("cls"),
            _ => (!function.is_static).then_some("self"),
        };
        for (k, (parameters, returns)) in overloads.iter().enumerate() {
            if class.is_empty() {
                self.text.push('\n');
            }
            if overloads.len() > 1 {
                writeln!(self.text, "{indent}@overload").unwrap();
            }
            if !class.is_empty() && first.is_none() {
                writeln!(self.text, "{indent}@staticmethod").unwrap();
            }
            let mut parameters = listed(first, parameters);
            if function.name.starts_with("__") && !matches!(&*function.name, "__new__" | "__call__") {
                parameters += ", /";
            }
            write!(self.text, "{indent}def {}({parameters}) -> {returns}:", function.name).unwrap();
            let doc = if k == 0 && function.name != "__new__" { &*function.doc } else { "" };
            self.doc(doc, if class.is_empty() { 1 } else { 2 });
        }
    }

    /// Returns the parameters and the result of each overload.
    fn overloads(&self, parameters: &[Parameter], returns: &str) -> Vec<(Vec<Parameter>, String)> {
        let place = |name: &str| parameters.iter().position(|parameter| parameter.name == name);
        if let (Some(k), Some((without, with))) =
            (DECIDING.iter().find_map(|name| place(name)), returns.split_once(" | "))
            && with != "None"
        {
            let decided = |kind: &str, default: Option<&str>| {
                let mut parameters = parameters.to_vec();
                (parameters[k].kind, parameters[k].default) = (kind.into(), default.map(Into::into));
                parameters
            };
            let kind = parameters[k].kind.replace(" | None", "");
            return vec![(decided("None", Some("None")), without.into()), (decided(&kind, None), with.into())];
        }
        let (Some(k), Some(rest)) = (place("solver"), place("options")) else {
            return vec![(parameters.to_vec(), returns.into())];
        };
        let callable =
            parameters[k].kind.contains("Callable").then(|| ("Callable[..., ArrayLike]".into(), String::new()));
        // Keywords that `Solver` and `solve_batch` take as options have parameters of their own in `solve`.
        let setting = if place("positions").is_some() { "" } else { "Setting" };
        let mut overloads = Vec::new();
        for (kind, keywords) in self.solvers.iter().cloned().chain(callable) {
            let options = match (&*kind, format!("{setting}{keywords}")) {
                ("str", options) if options.is_empty() => None,
                (_, options) if options.is_empty() => Some("Any".into()),
                (_, options) => Some(format!("Unpack[k.{options}]")),
            };
            let mut named = parameters.to_vec();
            named[k].default = (kind == "None").then(|| "None".into());
            named[k].kind = kind;
            match options {
                Some(options) => named[rest].kind = options,
                None => drop(named.remove(rest)),
            }
            if named[k].default.is_none() && named[..k].iter().any(|one| one.default.is_some()) {
                // By position, if all before it are given; else by keyword.
                let mut all = named.clone();
                all[..k].iter_mut().for_each(|one| one.default = None);
                overloads.push((all, returns.into()));
                named[k..]
                    .iter_mut()
                    .filter(|one| one.passing == Passing::ByPosition)
                    .for_each(|one| one.passing = Passing::ByKeyword);
            }
            overloads.push((named, returns.into()));
        }
        overloads
    }

    /// Ends a definition with its docstring.
    fn doc(&mut self, doc: &str, depth: usize) {
        if doc.is_empty() {
            self.text += " ...\n";
            return;
        }
        let indent = "    ".repeat(depth);
        let raw = if doc.contains('\\') { "r" } else { "" };
        let end = if doc.contains('\n') { format!("\n{indent}") } else { String::new() };
        let body = doc.replace('\n', &format!("\n{indent}")).replace(&format!("\n{indent}\n"), "\n\n");
        write!(self.text, "\n{indent}{raw}\"\"\"{body}{end}\"\"\"\n").unwrap();
    }
}

/// Returns a function's parameters as text.
fn listed(first: Option<&str>, parameters: &[Parameter]) -> String {
    let mut listed: Vec<_> = first.map(Into::into).into_iter().collect();
    let mut passing = Passing::ByPosition;
    for Parameter { name, kind, passing: own, default } in parameters {
        if *own == Passing::ByKeyword && passing == Passing::ByPosition {
            listed.push("*".to_owned());
        }
        passing = *own;
        let stars = if *own == Passing::Others { "**" } else { "" };
        let default = default.as_ref().map_or_else(String::new, |default| format!(" = {default}"));
        listed.push(format!("{stars}{name}: {kind}{default}"));
    }
    listed.join(", ")
}

/// Returns a default value of Rust in Python.
fn python(value: &str) -> String {
    match value {
        "true" => "True".into(),
        "false" => "False".into(),
        "None" => value.into(),
        _ if value.starts_with(['"', '\'', '(', '-']) || value.starts_with(char::is_numeric) => value.into(),
        _ => "...".into(),
    }
}

/// Returns the name in the stub of a function of the package.
fn local(home: &str, function: &str) -> String {
    format!("_{}_{function}", home.trim_start_matches('_').replace('.', ""))
}

/// Reads the methods that `_toolbox.py` adds to classes: `{Class: {"name": Later("home", "function")}}`.
fn attached(toolbox: &str) -> Vec<Attached> {
    let table = toolbox.split_once("METHODS: dict[type, dict[str, Later]] = {").unwrap().1.split_once("\n}").unwrap().0;
    let read = |input: ParseStream<'_>| {
        let mut found = Vec::new();
        while !input.is_empty() {
            let class = input.parse::<Ident>()?.to_string();
            input.parse::<Token![:]>()?;
            let methods;
            syn::braced!(methods in input);
            input.parse::<Option<Token![,]>>()?;
            while !methods.is_empty() {
                let name = methods.parse::<LitStr>()?.value();
                methods.parse::<Token![:]>()?;
                methods.parse::<Ident>()?;
                let call;
                syn::parenthesized!(call in methods);
                methods.parse::<Option<Token![,]>>()?;
                let home = call.parse::<LitStr>()?.value();
                call.parse::<Token![,]>()?;
                let function = call.parse::<LitStr>()?.value();
                call.parse::<proc_macro2::TokenStream>()?;
                found.push(Attached { class: class.clone(), name, home, function });
            }
        }
        Ok(found)
    };
    read.parse_str(table).unwrap()
}
