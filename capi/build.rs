//! Sets the name under which programs load the shared library: libmidair.so.ABI.

#[allow(unreachable_pub, reason = "the library's, where it can be reached")]
#[path = "src/abi.rs"]
mod abi;

fn main() {
    println!("cargo::rerun-if-changed=src/abi.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libmidair.so.{}", abi::MIDAIR_ABI);
    }
}
