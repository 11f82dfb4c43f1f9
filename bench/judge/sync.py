#!/usr/bin/env python3
"""sync.py WHICH [TREE]: copies the core of a checkout to WHICH/core, with one instruction set (a fast build)."""
import os, re, sys, shutil
which, tree = sys.argv[1], (sys.argv[2:] or ["../.."])[0]
src, dst = f"{tree}/core/src", f"./tree/core/src"
seen = set()
for base, _, files in os.walk(src):
    if "/tests" in base: continue
    for f in files:
        p = os.path.join(base, f); rel = os.path.relpath(p, src); q = os.path.join(dst, rel); seen.add(rel)
        data = open(p, "rb").read()
        if rel == "kernels/simd/instruction_set.rs":
            t = data.decode()
            a = t.index("match $set.0 {\n            Kind::Scalar($simd)")
            b = t.index("#[cfg(target_arch = \"x86_64\")]\n            Kind::Avx512($simd)")
            e = t.index("pub(crate) use dispatch;")
            t = t[:a] + """let token = match $set.0 {
            Kind::Avx512(token) => token,
            _ => match crate::kernels::simd::instruction_set::InstructionSet::best().0 { Kind::Avx512(token) => token, _ => unreachable!() },
        };
        let $simd = token;
        $simd.vectorize(
            #[inline(always)]
            || $body,
        )
    }};
}
""" + t[e:]
            data = t.encode()
        if not os.path.exists(q) or open(q, "rb").read() != data:
            os.makedirs(os.path.dirname(q), exist_ok=True); open(q, "wb").write(data)
def put(rel, data):
    q=os.path.join(dst, rel); seen.add(rel)
    if not os.path.exists(q) or open(q).read() != data: open(q,"w").write(data)
lib=open(src+"/lib.rs").read()
put("judge_main.rs", "#![allow(warnings)]\n"+lib.replace("missing_docs","")+"\nmod judge;\nfn main() { judge::main() }\n")
put("judge.rs", open("./main.rs").read())
import re as _re
names=[]
T=src.replace("/core/src","/core/tests/suite")
put("scenes.rs", open(T+"/scenes.rs").read())
if os.path.exists(T+"/oracle.rs"): put("oracle.rs", open(T+"/oracle.rs").read())
os.makedirs(dst+"/oracle", exist_ok=True)
for f in os.listdir(T+"/oracle"):
    if f.endswith(".rs"): put("oracle/"+f, "") ; continue
    if f.endswith(".rs"): put("oracle/"+f, _re.sub(r"#\[test\]\n","",open(T+"/oracle/"+f).read()))
for m in ("even",):
    t=open(T+f"/{m}.rs").read()
    for n in _re.findall(r"#\[test\]\n(?:#\[[^\n]*\n)*fn (\w+)", t): names.append((m,n))
    t=_re.sub(r"#\[test\]\n","pub(crate) ",t) if False else _re.sub(r"#\[test\]\n(#\[[^\n]*\n)*fn","pub(crate) fn",t)
    put(f"t_{m}.rs", t)
lines="\n".join(f'    run("{m}::{n}", crate::t_{m}::{n});' for m,n in names)
put("t_all.rs", "pub(crate) fn all() {\n    let run = |n: &str, f: fn()| { let only: Vec<String> = std::env::args().skip(2).collect(); if only.is_empty() || only.iter().any(|o| n.contains(o.as_str())) { let t = std::time::Instant::now(); let ok = std::panic::catch_unwind(f).is_ok(); println!(\"{} {n} {:.1} s\", if ok { \"ok\" } else { \"FAILED\" }, t.elapsed().as_secs_f64()); } };\n"+lines+"\n}\n")
j=open(dst+"/judge_main.rs").read()
put("judge_main.rs", j.replace("\nmod judge;\nfn main() { judge::main() }\n","\nmod judge; mod oracle; mod scenes; "+" ".join(f"mod t_{m};" for m in ("even",))+" mod t_all;\nfn main() { if std::env::args().nth(1).as_deref() == Some(\"tests\") { return t_all::all(); } judge::main() }\n"))
for base, _, files in os.walk(dst):
    for f in files:
        rel = os.path.relpath(os.path.join(base, f), dst)
        if rel not in seen: os.remove(os.path.join(base, f))
