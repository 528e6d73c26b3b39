//! Parameter requests beside their limits: parse one under 20 ns, build its answer under 50 ns.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use profidrive_profile::parameter::{Dialect, ParameterAddress, Request, RequestId, Response, serve};

mod one_word;
use one_word::OneWord;

fn benches(criterion: &mut Criterion) {
    let read = [5, 1, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0];
    let change = [5, 2, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, 0x42, 1, 0, 2];
    let answer = [5, 1, 0, 1, 0x42, 1, 0, 1];
    let mut group = criterion.benchmark_group("one parameter");
    group.bench_function("parse a read request (limit 20 ns)", |bencher| {
        bencher.iter(|| {
            let request = Request::parse(black_box(&read), Dialect::AKD.code_space).ok()?;
            Some((request.id(), request.axis(), request.addresses().next()?))
        });
    });
    group.bench_function("parse a change request with its value (limit 20 ns)", |bencher| {
        bencher.iter(|| {
            let request = Request::parse(black_box(&change), Dialect::AKD.code_space).ok()?;
            let value = request.values().next()?.ok()?.raw(0)?;
            Some((request.id(), request.addresses().next()?, value))
        });
    });
    let (mut drive, mut out) = (OneWord(1), [0; 240]);
    group.bench_function(
        "parse, look up and build the answer of a read (limit 50 ns)",
        |bencher| {
            bencher.iter(|| serve(black_box(&read), &Dialect::AKD, &mut drive, &mut out));
        },
    );
    group.bench_function(
        "parse, write and build the answer of a change (limit 50 ns)",
        |bencher| {
            bencher.iter(|| serve(black_box(&change), &Dialect::AKD, &mut drive, &mut out));
        },
    );
    let addresses = [ParameterAddress::value(930, 0)];
    group.bench_function("read the answer", |bencher| {
        bencher.iter(|| {
            let response =
                Response::parse(black_box(&answer), RequestId::Read, 5, &addresses, &Dialect::AKD).ok()?;
            response.answers().next()
        });
    });
    group.finish();
}

criterion_group!(parameter, benches);
criterion_main!(parameter);
