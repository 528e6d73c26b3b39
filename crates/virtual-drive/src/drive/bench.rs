//! A drive with a controller and a parameter tool, for the tests of the vendors.

use super::*;

pub(super) struct Bench {
    pub drive: Drive,
    pub now: Instant,
    pub outputs: Vec<u8>,
    pub inputs: Vec<u8>,
}

pub(super) const CYCLE: Duration = Duration::from_millis(4);

impl Bench {
    pub fn new(model: &'static Model, telegram: u16) -> Self {
        let module = model.catalogue.device.telegram(telegram).unwrap();
        let mut drive = Drive::new(model);
        drive.connect(telegram, 3 * CYCLE).unwrap();
        Self {
            drive,
            now: Instant::ZERO,
            outputs: vec![0; module.outputs.into()],
            inputs: vec![0; module.inputs.into()],
        }
    }

    pub fn ticks(&mut self, count: usize) {
        for _ in 0..count {
            self.now += CYCLE;
            self.drive.tick(self.now, Some(&self.outputs), &mut self.inputs);
        }
    }

    /// Lets a time in ms pass without a controller.
    pub fn without_controller(&mut self, milliseconds: usize) {
        for _ in 0..milliseconds / 4 {
            self.now += CYCLE;
            self.drive.tick(self.now, None, &mut []);
        }
    }

    /// Octet at which the control word is.
    fn at(&self) -> usize {
        if self
            .drive
            .process
            .own_telegram()
            .is_some_and(|telegram| telegram.pkw)
        {
            8
        } else {
            0
        }
    }

    /// Sends control word and speed for a time in ms; the status word then.
    pub fn send(&mut self, control: u16, speed: i16, milliseconds: usize) -> u16 {
        let at = self.at();
        self.outputs[at..at + 2].copy_from_slice(&control.to_be_bytes());
        self.outputs[at + 2..at + 4].copy_from_slice(&speed.to_be_bytes());
        self.ticks(milliseconds / 4);
        self.status()
    }

    pub fn status(&self) -> u16 {
        let at = self.at();
        u16::from_be_bytes([self.inputs[at], self.inputs[at + 1]])
    }

    pub fn speed(&self) -> i16 {
        let at = self.at();
        i16::from_be_bytes([self.inputs[at + 2], self.inputs[at + 3]])
    }

    /// Answer to a parameter request.
    pub fn ask(&mut self, request: &[u8]) -> Vec<u8> {
        ask(&mut self.drive, request)
    }

    pub fn read(&mut self, number: u16) -> i64 {
        self.drive.parameter(number).unwrap()
    }

    pub fn write(&mut self, number: u16, raw: i64) -> Result<(), profile::parameter::ErrorNumber> {
        let position = crate::model::numbered(self.drive.model.catalogue, number).unwrap();
        self.drive.set_element(position, 0, raw)
    }
}

pub(super) fn ask(drive: &mut Drive, request: &[u8]) -> Vec<u8> {
    let mut out = [0; 240];
    let length = drive.serve(request, &mut out).unwrap();
    out[..length].to_vec()
}
