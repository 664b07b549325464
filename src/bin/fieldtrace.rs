//! The command `trace` under the name of the package, where another `trace` is installed.

/// The stages and training make many large temporaries, which this allocator keeps for the next.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    fieldtrace::cli::main()
}
