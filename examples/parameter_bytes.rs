//! Parameter requests and responses as bytes: no drive, no network.
//!
//! `cargo run -p examples --example parameter_bytes`

use std::error::Error;

use profile::parameter::{
    Answer, Dialect, Format, NewValue, ParameterAddress, RequestId, Response, encode_change, encode_read,
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut buffer = [0; 240];

    // Operating mode (PNU 930) := 2, as the AKD manual prints it.
    let change = NewValue {
        address: ParameterAddress::value(930, 0),
        format: Format::WORD,
        count: 1,
        data: &[0, 2],
    };
    let length = encode_change(5, &Dialect::AKD, &[change], &mut buffer)?;
    println!("change 930 := 2    {:02x?}", &buffer[..length]);

    // Two parameters in one request; the drive knows only the first.
    let addresses = [ParameterAddress::value(930, 0), ParameterAddress::value(65534, 0)];
    let length = encode_read(7, &Dialect::AKD, &addresses, &mut buffer)?;
    println!("read 930 and 65534 {:02x?}", &buffer[..length]);

    let bytes = [0x07, 0x81, 0, 2, 0x42, 1, 0, 2, 0x44, 1, 0, 0];
    let response = Response::parse(&bytes, RequestId::Read, 7, &addresses, &Dialect::AKD)?;
    for (address, answer) in addresses.iter().zip(response.answers()) {
        match answer {
            Answer::Values(block) => println!("p{:04} = {:?}", address.pnu, block.raw(0)),
            Answer::Written => println!("p{:04} written", address.pnu),
            Answer::Error(error) => println!("p{:04} refused: {error}", address.pnu),
        }
    }
    Ok(())
}
