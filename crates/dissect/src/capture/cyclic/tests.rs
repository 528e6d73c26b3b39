use super::super::event::Party;
use super::super::tests::{connect_blocks, connected_blocks};
use super::*;
use profinet::wire::Reader;
use profinet::wire::ethernet::FrameId;

fn mac(number: u16) -> MacAddress {
    let [high, low] = number.to_be_bytes();
    MacAddress([2, 0, 0, 1, high, low])
}

fn uuid(number: u16) -> Uuid {
    let [high, low] = number.to_be_bytes();
    let mut uuid = [9; 16];
    uuid[..2].copy_from_slice(&[high, low]);
    Uuid(uuid)
}

/// The connect of a device with two streams.
fn asked(number: u16) -> Asked {
    let mut asked = connect::request(Reader::new(&connect_blocks(9))).unwrap();
    asked.ar.as_mut().unwrap().ar_uuid = uuid(number);
    asked
}

/// Looks at a frame of a station; true where there is room for its connection.
fn has_room(ars: &mut CyclicArs, number: u16, at: Duration) -> bool {
    let mut sink = Sink {
        frame: 1,
        at,
        source: Party::default(),
        target: Party::default(),
        events: &mut Vec::new(),
    };
    let frame = Frame {
        destination: mac(0xFFFF),
        source: mac(number),
        tag: None,
        frame_id: FrameId(0x8000),
        payload: &[0; 44],
    };
    ars.cyclic(&frame, &mut Names::default(), &mut sink).is_some()
}

#[test]
fn connections_from_before_the_capture_are_bounded_and_make_room_when_they_are_gone() {
    let mut ars = CyclicArs::default();
    for number in 0..300 {
        assert_eq!(has_room(&mut ars, number, Duration::ZERO), number < 256);
    }
    assert!(has_room(&mut ars, 300, GONE + LOOK));
    assert_eq!(ars.streams.len(), MAX_EARLIER);
    assert_eq!(ars.streams[0].sender, mac(1), "the first one made room");
}

#[test]
fn connects_without_an_answer_are_bounded_and_the_oldest_go() {
    let mut ars = CyclicArs::default();
    let drive = JobDrive::default();
    for number in 0..600 {
        ars.announce(&asked(number), mac(number), Ipv4Addr::LOCALHOST, &drive);
    }
    let announced: Vec<Uuid> = ars.announced.iter().map(|stream| stream.ar).collect();
    let newest = (600 - 512..600).flat_map(|number| [uuid(number); 2]);
    assert_eq!(announced, newest.collect::<Vec<_>>());
}

/// More parts than the data can have octets.
#[test]
fn the_layout_of_a_connection_is_bounded() {
    let mut asked = asked(1);
    for iocr in &mut asked.iocrs {
        for api in &mut iocr.apis {
            api.data = vec![api.data[0]; 1000];
            api.status = vec![api.data[0]; 1000];
        }
    }
    let mut ars = CyclicArs::default();
    ars.announce(&asked, mac(1), Ipv4Addr::LOCALHOST, &JobDrive::default());
    let objects: Vec<usize> = ars.announced.iter().map(|stream| stream.objects.len()).collect();
    assert_eq!(objects, [MAX_OBJECTS; 2]);
}

#[test]
fn accepted_connections_are_bounded_and_those_from_before_the_capture_go_first() {
    let mut ars = CyclicArs::default();
    assert!(has_room(&mut ars, 0xFF00, Duration::ZERO));
    let drive = JobDrive::default();
    let mut response = ConnectResponse::decode(Reader::new(&connected_blocks(9, None))).unwrap();
    for number in 0..1100 {
        response.ar.ar_uuid = uuid(number);
        response.ar.responder_mac = mac(number);
        ars.open(&asked(number), &response, Ipv4Addr::LOCALHOST, &drive);
        let earlier = ars.streams.iter().any(|stream| stream.data_length.is_none());
        assert_eq!(earlier, number < 511);
    }
    let streams: Vec<Uuid> = ars.streams.iter().map(|stream| stream.ar).collect();
    let newest = (1100 - 512..1100).flat_map(|number| [uuid(number); 2]);
    assert_eq!(streams, newest.collect::<Vec<_>>());
    // figures for the summary: the first ones
    assert_eq!((ars.tracks.len(), ars.devices.len()), (MAX_STREAMS, MAX_STREAMS));
    assert_eq!(
        (ars.device(mac(1023)).connects, ars.device(mac(1024)).connects),
        (1, 0)
    );
}
