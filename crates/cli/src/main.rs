//! The `profidrive` command.
#![forbid(unsafe_code)]

fn main() -> std::process::ExitCode {
    profidrive_cli::main()
}
