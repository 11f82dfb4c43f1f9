//! Source: what the extension exports, read from its Rust source.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use quote::ToTokens;
use syn::parse::{Parse, ParseStream, Parser};
use syn::punctuated::Punctuated;
use syn::{
    Attribute, Expr, FnArg, Ident, ImplItem, Item, ItemStruct, Lit, LitStr, Meta, ReturnType, Token, Type, UseTree,
};

/// All declarations by their names in Rust, and the exported names.
#[derive(Default)]
pub(crate) struct Source {
    pub(crate) exported: Vec<String>,
    pub(crate) constants: Vec<Property>,
    pub(crate) exceptions: BTreeMap<String, Exception>,
    pub(crate) classes: BTreeMap<String, Class>,
    pub(crate) functions: BTreeMap<String, Function>,
    /// Each `type Name = ...`.
    pub(crate) aliases: BTreeMap<String, Type>,
}

pub(crate) struct Exception {
    pub(crate) base: String,
    pub(crate) doc: String,
}

#[derive(Default)]
pub(crate) struct Class {
    pub(crate) doc: String,
    /// The text in `#[pyclass(...)]`.
    pub(crate) options: String,
    pub(crate) properties: Vec<Property>,
    pub(crate) methods: Vec<Function>,
}

pub(crate) struct Property {
    pub(crate) name: String,
    pub(crate) kind: Type,
    pub(crate) doc: String,
}

#[derive(Clone)]
pub(crate) struct Function {
    pub(crate) name: String,
    pub(crate) doc: String,
    /// Whether it has no `self`.
    pub(crate) is_static: bool,
    pub(crate) arguments: Vec<Argument>,
    pub(crate) returns: Option<Type>,
}

#[derive(Clone)]
pub(crate) struct Argument {
    pub(crate) name: String,
    pub(crate) kind: Type,
    pub(crate) passing: Passing,
    /// The default value in Rust.
    pub(crate) default: Option<String>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Passing {
    ByPosition,
    ByKeyword,
    /// All other keywords, as `**name`.
    Others,
}

impl Source {
    /// Reads every file of a folder.
    pub(crate) fn read(folder: &Path) -> Self {
        let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        let mut source = Self::default();
        for path in paths {
            let file = syn::parse_file(&fs::read_to_string(path).unwrap()).unwrap();
            file.items.into_iter().for_each(|item| source.add(item));
        }
        source
    }

    fn add(&mut self, item: Item) {
        match item {
            Item::Struct(item) if has(&item.attrs, "pyclass") => self.add_class(item),
            Item::Impl(item) if has(&item.attrs, "pymethods") => {
                let class = self.classes.entry(text(&item.self_ty)).or_default();
                for item in item.items {
                    if let ImplItem::Fn(item) = item {
                        class.add(&item.attrs, &item.sig);
                    }
                }
            }
            Item::Fn(item) if has(&item.attrs, "pyfunction") => {
                self.functions.insert(item.sig.ident.to_string(), Function::of(&item.attrs, &item.sig));
            }
            Item::Type(item) => drop(self.aliases.insert(item.ident.to_string(), *item.ty)),
            Item::Macro(item) => self.add_declared(&item.mac),
            Item::Mod(item) if has(&item.attrs, "pymodule") => {
                item.content.into_iter().flat_map(|(_, items)| items).for_each(|item| self.export(item));
            }
            _ => {}
        }
    }

    fn add_class(&mut self, item: ItemStruct) {
        let class = self.classes.entry(item.ident.to_string()).or_default();
        (class.doc, class.options) = (doc(&item.attrs), written(&item.attrs, "pyclass"));
        for field in item.fields {
            let shown = class.options.contains("get_all") || written(&field.attrs, "pyo3").contains("get");
            if let (true, Some(name)) = (shown, field.ident) {
                class.properties.push(Property { name: name.to_string(), kind: field.ty, doc: doc(&field.attrs) });
            }
        }
    }

    /// Adds what a macro declares.
    fn add_declared(&mut self, called: &syn::Macro) {
        match called.path.segments.last().unwrap().ident.to_string().as_str() {
            "getters" => {
                let Getters { class, properties } = called.parse_body().unwrap();
                self.classes.entry(class).or_default().properties.extend(properties);
            }
            "bodies" => {
                for Body { name, class } in called.parse_body_with(all::<Body>).unwrap() {
                    self.exported.push(name.clone());
                    self.classes.insert(name, class);
                }
            }
            "metrics" => {
                let numbers: [Type; 2] = [syn::parse_quote!(f64), syn::parse_quote!(PyArray1<f64>)];
                for (class, kind) in ["Metrics", "BatchMetrics"].into_iter().zip(numbers) {
                    let property = |(name, doc)| Property { name, kind: kind.clone(), doc };
                    let properties = metrics().into_iter().map(property);
                    self.classes.entry(class.into()).or_default().properties.extend(properties);
                }
            }
            "create_exception" => {
                let Raised { name, exception } = called.parse_body().unwrap();
                self.exceptions.insert(name, exception);
            }
            _ => {}
        }
    }

    fn export(&mut self, item: Item) {
        match item {
            Item::Use(item) if has(&item.attrs, "pymodule_export") => leaves(&item.tree, &mut self.exported),
            Item::Const(item) if has(&item.attrs, "pymodule_export") => {
                let (name, doc) = (item.ident.to_string(), doc(&item.attrs));
                self.constants.push(Property { name, kind: *item.ty, doc });
            }
            _ => {}
        }
    }
}

impl Class {
    fn add(&mut self, attributes: &[Attribute], signature: &syn::Signature) {
        let Function { name, doc, returns, .. } = Function::of(attributes, signature);
        match returns {
            Some(kind) if has(attributes, "getter") => self.properties.push(Property { name, kind, doc }),
            _ => self.methods.push(Function::of(attributes, signature)),
        }
    }
}

impl Function {
    fn of(attributes: &[Attribute], signature: &syn::Signature) -> Self {
        let mut inputs = Vec::new();
        for input in &signature.inputs {
            if let FnArg::Typed(input) = input {
                inputs.push((text(&input.pat), (*input.ty).clone()));
            }
        }
        let is_static = inputs.len() == signature.inputs.len() && inputs.iter().all(|(name, _)| name != "slf");
        inputs.retain(|(name, _)| name != "slf" && name != "py");
        let Options { name, arguments } = Options::of(attributes);
        let positional = |(name, _): &(String, Type)| (name.clone(), Passing::ByPosition, None);
        let stated = arguments.unwrap_or_else(|| inputs.iter().map(positional).collect());
        let arguments = stated.into_iter().map(|(name, passing, default)| {
            let (_, kind) = inputs.iter().find(|(input, _)| *input == name).unwrap().clone();
            Argument { name, kind, passing, default }
        });
        Self {
            name: if has(attributes, "new") {
                "_new".into()
            } else {
                name.unwrap_or_else(|| signature.ident.to_string())
            },
            doc: doc(attributes),
            is_static,
            arguments: arguments.collect(),
            returns: match &signature.output {
                ReturnType::Type(_, kind) => Some((**kind).clone()),
                ReturnType::Default => None,
            },
        }
    }
}

/// Name, passing and default of each argument.
type Stated = Vec<(String, Passing, Option<String>)>;

/// Options in `#[pyo3(...)]` and `#[pyfunction(...)]`.
#[derive(Default)]
struct Options {
    name: Option<String>,
    arguments: Option<Stated>,
}

impl Options {
    fn of(attributes: &[Attribute]) -> Self {
        let mut options = Self::default();
        for attribute in attributes {
            let known = attribute.path().is_ident("pyo3") || attribute.path().is_ident("pyfunction");
            if !known || !matches!(attribute.meta, Meta::List(_)) {
                continue;
            }
            let parsed = attribute.parse_nested_meta(|meta| {
                let value = meta.value()?;
                if meta.path.is_ident("name") {
                    options.name = Some(value.parse::<LitStr>()?.value());
                } else if meta.path.is_ident("signature") {
                    let inner;
                    syn::parenthesized!(inner in value);
                    options.arguments = Some(stated(&inner)?);
                } else if meta.path.is_ident("text_signature") {
                    let text = value.parse::<LitStr>()?.value();
                    let inner = text.strip_prefix('(').and_then(|text| text.strip_suffix(')')).unwrap();
                    options.arguments = Some(stated.parse_str(inner)?);
                }
                Ok(())
            });
            parsed.unwrap();
        }
        options
    }
}

/// Reads the arguments of a signature, such as `a, b=None, *, c=1, **others`.
fn stated(input: ParseStream<'_>) -> syn::Result<Stated> {
    let mut stated = Stated::new();
    let mut passing = Passing::ByPosition;
    while !input.is_empty() {
        if input.parse::<Option<Token![*]>>()?.is_some() {
            let others = input.parse::<Option<Token![*]>>()?.is_some();
            passing = if others { Passing::Others } else { Passing::ByKeyword };
        }
        if !input.peek(Token![,]) {
            let name = input.parse::<Ident>()?.to_string();
            let default = input.parse::<Option<Token![=]>>()?.map(|_| input.parse::<Expr>()).transpose()?;
            stated.push((name, passing, default.map(|value| text(&value))));
        }
        input.parse::<Option<Token![,]>>()?;
    }
    Ok(stated)
}

/// `Class: name(self, py) -> Type = value; ...`
struct Getters {
    class: String,
    properties: Vec<Property>,
}

impl Parse for Getters {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let class = input.parse::<Ident>()?.to_string();
        input.parse::<Token![:]>()?;
        let mut properties = Vec::new();
        while !input.is_empty() {
            let (attributes, name) = (Attribute::parse_outer(input)?, input.parse::<Ident>()?.to_string());
            let arguments;
            syn::parenthesized!(arguments in input);
            arguments.parse::<TokenStream>()?;
            input.parse::<Token![->]>()?;
            properties.push(Property { name, kind: input.parse()?, doc: doc(&attributes) });
            input.parse::<Token![=]>()?;
            input.parse::<Expr>()?;
            input.parse::<Token![;]>()?;
        }
        Ok(Self { class, properties })
    }
}

/// `Name { part: Type, ... }`, the class of an obstacle that a few numbers describe.
struct Body {
    name: String,
    class: Class,
}

impl Parse for Body {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let (attributes, name) = (Attribute::parse_outer(input)?, input.parse::<Ident>()?);
        let content;
        syn::braced!(content in input);
        let fields = Punctuated::<syn::Field, Token![,]>::parse_terminated_with(&content, syn::Field::parse_named)?;
        let kind = |kind| Property { name: "kind".into(), kind, doc: "\"rigid\" or \"soft\".".into() };
        let properties = fields.into_iter().map(|field| Property {
            name: field.ident.unwrap().to_string(),
            kind: field.ty,
            doc: doc(&field.attrs),
        });
        let properties: Vec<_> = properties.chain([kind(syn::parse_str("&str")?)]).collect();
        let argument = |part: &Property| Argument {
            name: part.name.clone(),
            kind: part.kind.clone(),
            passing: Passing::ByPosition,
            default: (part.name == "kind").then(|| "\"rigid\"".into()),
        };
        let new = Function {
            name: "_new".into(),
            doc: String::new(),
            is_static: true,
            arguments: properties.iter().map(argument).collect(),
            returns: None,
        };
        let class = Class { doc: doc(&attributes), options: "eq, hash".into(), properties, methods: vec![new] };
        Ok(Self { name: name.to_string(), class })
    }
}

/// `module, Name, base, "doc"`, an exception.
struct Raised {
    name: String,
    exception: Exception,
}

impl Parse for Raised {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let parts = Punctuated::<Expr, Token![,]>::parse_terminated(input)?;
        let parts: Vec<_> = parts.iter().map(text).collect();
        let base = parts[2].rsplit("Py").next().unwrap_or_default().to_owned();
        let doc = syn::parse_str::<LitStr>(&parts[3])?.value();
        Ok(Self { name: parts[1].clone(), exception: Exception { base, doc } })
    }
}

/// Returns name and docstring of each metric, which the core's macro `metrics!` lists.
fn metrics() -> Vec<(String, String)> {
    let core = syn::parse_file(&fs::read_to_string("../core/src/problem/metrics.rs").unwrap()).unwrap();
    let named = |item| match item {
        Item::Macro(item) if item.ident.as_ref().is_some_and(|name| name == "metrics") => listed(item.mac.tokens),
        _ => None,
    };
    core.items.into_iter().find_map(named).unwrap()
}

/// Returns the first list of documented names in braces.
fn listed(tokens: TokenStream) -> Option<Vec<(String, String)>> {
    let names = |input: ParseStream<'_>| {
        let mut names = Vec::new();
        while !input.is_empty() {
            let doc = doc(&Attribute::parse_outer(input)?);
            names.push((input.parse::<Ident>()?.to_string(), doc));
        }
        Ok(names)
    };
    tokens.into_iter().find_map(|token| match token {
        TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => {
            names.parse2(group.stream()).ok().or_else(|| listed(group.stream()))
        }
        _ => None,
    })
}

/// Reads values until the end.
fn all<T: Parse>(input: ParseStream<'_>) -> syn::Result<Vec<T>> {
    let mut values = Vec::new();
    while !input.is_empty() {
        values.push(input.parse()?);
    }
    Ok(values)
}

/// Adds the last names of a `use`.
fn leaves(tree: &UseTree, names: &mut Vec<String>) {
    match tree {
        UseTree::Path(path) => leaves(&path.tree, names),
        UseTree::Group(group) => group.items.iter().for_each(|item| leaves(item, names)),
        UseTree::Name(name) => names.push(name.ident.to_string()),
        _ => {}
    }
}

fn has(attributes: &[Attribute], name: &str) -> bool {
    attributes.iter().any(|one| one.path().is_ident(name))
}

/// Returns what an attribute has in parentheses.
fn written(attributes: &[Attribute], name: &str) -> String {
    let lists =
        attributes.iter().filter(|one| one.path().is_ident(name)).filter_map(|one| one.meta.require_list().ok());
    lists.map(|list| list.tokens.to_string()).collect()
}

/// Returns the text of doc comments.
fn doc(attributes: &[Attribute]) -> String {
    let lines = attributes.iter().filter_map(|one| match &one.meta {
        Meta::NameValue(meta) if meta.path.is_ident("doc") => match &meta.value {
            Expr::Lit(value) => match &value.lit {
                Lit::Str(line) => Some(line.value()),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    });
    let lines: Vec<_> = lines.map(|line| line.strip_prefix(' ').unwrap_or(&line).to_owned()).collect();
    lines.join("\n").trim().to_owned()
}

/// Returns the Rust text of a part of the source.
pub(crate) fn text(part: &impl ToTokens) -> String {
    part.to_token_stream().to_string()
}
