//! Prints the description of the interface: `cargo run -p profidrive-workbench --example openapi > crates/workbench/openapi.json`.

fn main() {
    print!("{}", profidrive_workbench::openapi());
}
