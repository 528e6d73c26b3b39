"""profinet-py as an independent controller: does one step after the other and prints one JSON object for each.

Written against the package's published interface (its README, help texts and signatures) only.

    profinetpy_controller.py --interface ctl0 --mac 02:50:4e:00:00:01 --name drive-one --ip 192.168.77.50 \
        --slots 0:1:0:0x1:0x1:0:0,1:1:0x3A00:0x10:0x1:4:4 --steps discover,name,ip,im0,connect,...

A slot is slot:subslot:api:module-ident:submodule-ident:input-octets:output-octets. With --gsdml the slots are what the
package makes of a device description: --access-point in slot 0 (the first one when left out), --module in slot 1 and
--submodule SUBSLOT:ID in it.
"""

import argparse
import json
import statistics
import sys
import time

import profinet
import profinet.rpc
from profinet.cyclic import CyclicController  # noqa: F401  (fails early when the package changed)

READ_PROFILE_IDENT = bytes.fromhex("01 01 00 01 10 01 03 c5 00 00")  # reference 1, read, axis 0, PNU 965
RATED = 0x4000
# seconds after which what is waited for does not come any more, on a machine of any load
LIMIT = 20.0


def say(step, **facts):
    print(json.dumps({"step": step, **facts}), flush=True)


def text(value):
    if isinstance(value, bytes):
        return value.decode("ascii", "replace").strip("\0 ")
    return str(value)


def choose_input_frame_id(frame_id):
    """Makes the package ask for another FrameID than its 0xC001: the device pnio knows those from 0x8000 to 0xBFFF only.

    The IOCR block holds its FrameID at offset 18 (block type 0x0102, input is IOCR type 1 at offset 6)."""
    build = profinet.rpc.RPCCon._build_iocr_block

    def built(*arguments, **named):
        block = bytearray(build(*arguments, **named))
        if block[0:2] == b"\x01\x02" and block[6:8] == b"\x00\x01":
            block[18:20] = frame_id.to_bytes(2, "big")
        return bytes(block)

    profinet.rpc.RPCCon._build_iocr_block = built


class Script:
    def __init__(self, arguments):
        self.arguments = arguments
        self.source = profinet.get_mac(arguments.interface)
        self.device = None
        self.cyclic = None
        self.states = []
        self.timeouts = 0
        self.errors = []
        self.inputs = []

    def socket(self):
        return profinet.ethernet_socket(self.arguments.interface)

    # ---- addressing ------------------------------------------------------------------------------------------------

    def discover(self):
        found = list(profinet.scan_dict(self.arguments.interface, timeout=3.0).values())
        mine = [d for d in found if d.mac.lower() == self.arguments.mac.lower()]
        if len(mine) != 1:
            raise SystemExit(f"heard {[d.mac for d in found]}, wanted {self.arguments.mac} once")
        d = mine[0]
        say("discover", mac=d.mac, name=d.name, ip=d.ip, vendor=d.vendor_id, device=d.device_id, count=len(found),
            kind=d.device_type, roles=d.device_roles)

    def name(self):
        sock = self.socket()
        ok = profinet.set_param(sock, self.source, self.arguments.mac, "name", self.arguments.name, permanent=True)
        sock.close()
        say("name", ok=bool(ok))

    def ip(self):
        sock = self.socket()
        ok = profinet.set_ip(sock, self.source, self.arguments.mac, self.arguments.ip, "255.255.255.0", "0.0.0.0",
                             permanent=True)
        sock.close()
        say("ip", ok=bool(ok))

    def signal(self):
        sock = self.socket()
        ok = profinet.signal_device(sock, self.source, self.arguments.mac)
        sock.close()
        say("signal", ok=bool(ok))

    def find(self):
        end = time.monotonic() + LIMIT
        while True:
            try:
                self.device = profinet.ProfinetDevice.discover(self.arguments.name, self.arguments.interface,
                                                               timeout=self.arguments.search_time)
                break
            # an answer may come later than a search lasts
            except Exception as error:
                if time.monotonic() > end:
                    raise SystemExit(f"find: {error!r}") from error
        say("find", name=self.device.name, ip=self.device.ip, mac=self.device.mac)

    # ---- acyclic ---------------------------------------------------------------------------------------------------

    def im0(self):
        # AR-less: works before any connection
        raw = self.device.read_implicit(0, 1, 0xAFF0)
        say("im0", raw=bytes(raw).hex())

    def access(self):
        """A connection for parameters only, opened by the package itself; reads I&M0 through it."""
        self.device.connect()
        im0 = self.device.read_im0()
        vendor = im0.vendor_id_high * 256 + im0.vendor_id_low
        say("access", vendor=vendor, order=text(im0.order_id), serial=text(im0.im_serial_number))
        self.device.disconnect()

    def im0_connected(self):
        """I&M0 through the connection that is open."""
        im0 = self.device.read_im0()
        vendor = im0.vendor_id_high * 256 + im0.vendor_id_low
        say("im0_connected", vendor=vendor, order=text(im0.order_id), serial=text(im0.im_serial_number))

    def endpoints(self):
        found = profinet.epm_lookup(self.arguments.ip, timeout=3.0)
        say("endpoints", count=len(found), annotations=[e.annotation for e in found], ports=[e.port for e in found])

    def job(self, request, index):
        """One parameter job: write the request, read the answer, again while the device says 'not ready'."""
        last = None
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            try:
                self.device.write(1, 1, index, request, api=0x3A00)
                break
            except profinet.PNIOError as error:
                last = error
                if "B5" not in str(error):
                    raise
                time.sleep(0.02)
        else:
            raise SystemExit(f"{request.hex()} on 0x{index:04X} is not taken: {last}")
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            try:
                answer = self.device.read(1, 1, index, api=0x3A00)
                if answer:
                    return bytes(answer)
            except profinet.PNIOError as error:
                last = error
            time.sleep(0.02)
        raise SystemExit(f"no answer to {request.hex()} on 0x{index:04X}: {last}")

    def records(self):
        for index in (0x002F, 0xB02E):
            answer = self.job(READ_PROFILE_IDENT, index)
            say("record", index=index, request=READ_PROFILE_IDENT.hex(), answer=answer.hex())
        for request in self.arguments.job:
            for index in (0x002F, 0xB02E):
                answer = self.job(bytes.fromhex(request), index)
                say("record", index=index, request=request, answer=answer.hex())

    # ---- cyclic ----------------------------------------------------------------------------------------------------

    def cyclic_slots(self):
        if self.arguments.gsdml:
            plugged = {}
            for text in self.arguments.submodule:
                subslot, name = text.split(":", 1)
                plugged[int(subslot, 0)] = name
            device = profinet.load_gsdml(self.arguments.gsdml)
            return device.build_io_slots({1: self.arguments.module}, {1: plugged} if plugged else None,
                                         self.arguments.access_point or None)
        slots = []
        for slot in self.arguments.slots.split(","):
            n = [int(part, 0) for part in slot.split(":")]
            slots.append(profinet.IOSlot(slot=n[0], subslot=n[1], api=n[2], module_ident=n[3], submodule_ident=n[4],
                                         input_length=n[5], output_length=n[6]))
        return slots

    def connect(self):
        setup = profinet.IOCRSetup(slots=self.cyclic_slots(), send_clock_factor=32,
                                   reduction_ratio=self.arguments.ratio, watchdog_factor=self.arguments.watchdog,
                                   data_hold_factor=self.arguments.watchdog)
        problems = setup.validate()
        if problems:
            raise SystemExit(f"setup: {problems}")
        self.started = time.monotonic()
        self.cyclic = self.device.start_cyclic(setup)
        self.cyclic.on_state_change(lambda old, new: self.states.append(new.name))
        self.cyclic.on_error(lambda message: self.errors.append(str(message)))
        self.cyclic.on_input(self.on_input)

        def on_timeout():
            self.timeouts += 1

        self.cyclic.on_timeout(on_timeout)
        say("connect", state=self.cyclic.state.name, cycle_ms=setup.cycle_time_ms)

    def on_input(self, slot, subslot, data):
        if slot == 1:
            self.inputs.append((time.monotonic(), bytes(data)))

    def statistics(self):
        stats = self.cyclic.stats if hasattr(self.cyclic, "stats") else None
        if stats is None:
            return {}
        return {"sent": stats.frames_sent, "received": stats.frames_received, "missed": stats.frames_missed,
                "invalid": stats.frames_invalid, "duplicate": stats.frames_duplicate,
                "disordered": stats.frames_out_of_order, "jitter_us": stats.max_jitter_us}

    def configure(self):
        """Parameter jobs through a connection without cyclic data, before a controller comes."""
        self.device.connect()
        for request in self.arguments.job:
            answer = self.job(bytes.fromhex(request), 0xB02E)
            say("record", index=0xB02E, request=request, answer=answer.hex())
        self.device.disconnect()

    def telegrams(self):
        """For each round: connects with its module in slot 1, sends each of its frames for a while, and reads its
        parameters while the frame stands, with the inputs before and after. A frame may be followed by what its inputs
        have to come to: `hexadecimal:offset:value`, a word with sign that is at most 7 away."""
        for number, text_of_round in enumerate(self.arguments.round):
            slots, frames, request = text_of_round.split("|")
            self.arguments.slots = slots
            self.find()
            self.connect()
            for frame in frames.split(","):
                frame, *wanted = frame.split(":")
                self.cyclic.set_output_data(1, self.arguments.subslot, bytes.fromhex(frame))
                self.exchange_for(self.arguments.hold)
                if wanted:
                    self.come_to(*(int(number) for number in wanted))
                before = bytes(self.cyclic.get_input_data(1, self.arguments.subslot))
                answer = self.job(bytes.fromhex(request), 0xB02E)
                # inputs that are surely newer than the answer, also when this process was held up meanwhile
                self.exchange_for(4 * self.arguments.ratio / 1000)
                after = bytes(self.cyclic.get_input_data(1, self.arguments.subslot))
                say("signals", round=number, output=frame, before=before.hex(), answer=answer.hex(), after=after.hex())
            say("round", round=number, state=self.cyclic.state.name, errors=self.errors, timeouts=self.timeouts)
            self.release()

    def exchange_for(self, seconds):
        """Lets the output stand for this time, and on a busy machine until so many cycles were really exchanged."""
        begin = self.statistics()
        time.sleep(seconds)
        cycles = seconds * 1000 / self.arguments.ratio
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            now = self.statistics()
            if all(now[way] - begin[way] >= cycles for way in ("sent", "received")):
                return self.catch_up(end)
            time.sleep(0.01)
        raise SystemExit(f"{cycles} cycles: not exchanged, {begin} {self.statistics()}")

    def catch_up(self, end):
        """Waits for an input that was waited for: those before it may have lain in a queue while this process was held up,
        and are older than they look."""
        begin = len(self.inputs)
        while time.monotonic() < end:
            times = [t for t, _ in self.inputs[max(begin - 1, 0):]]
            if any(later - earlier >= self.arguments.ratio / 2000 for earlier, later in zip(times, times[1:])):
                return
            time.sleep(0.005)
        raise SystemExit(f"the inputs are late all the time: {self.gaps()}")

    def come_to(self, offset, value):
        """Waits until a word of the inputs is near a value. Whoever compares the inputs sees that it never was."""
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            data = self.cyclic.get_input_data(1, self.arguments.subslot)
            if data and abs(int.from_bytes(data[offset:offset + 2], "big", signed=True) - value) < 8:
                return self.exchange_for(4 * self.arguments.ratio / 1000)
            time.sleep(0.01)

    def exchange(self):
        """Cyclic data for a while with no change, counting what is lost."""
        time.sleep(0.5)
        # a pause of the machine longer than a cycle is not a fault: a disturbed measurement is repeated, twice at most
        for attempt in range(1, 4):
            self.timeouts = 0
            before = self.statistics()
            time.sleep(self.arguments.seconds)
            after = self.statistics()
            facts = {key: after[key] - before[key] for key in after if key != "jitter_us"}
            if not any(facts[key] for key in ("missed", "invalid", "duplicate", "disordered")):
                break
        status = {f"{s.slot}.{s.subslot}": self.cyclic.get_input_status(s.slot, s.subslot)
                  for s in self.cyclic_slots() if s.input_length}
        say("exchange", state=self.cyclic.state.name, timeouts=self.timeouts, errors=self.errors, status=status,
            gaps=self.gaps(), attempts=attempt, **facts)

    def gaps(self):
        times = [t for t, _ in self.inputs[-500:]]
        steps = [(b - a) * 1000 for a, b in zip(times, times[1:])]
        return {"median_ms": round(statistics.median(steps), 3), "max_ms": round(max(steps), 3)} if steps else {}

    def inputs_now(self):
        data = self.cyclic.get_input_data(1, self.arguments.subslot)
        if data is None:
            return None, None
        zsw1 = int.from_bytes(data[0:2], "big")
        speed = int.from_bytes(data[2:4], "big", signed=True)
        return zsw1, speed

    def output(self, stw1, setpoint):
        self.cyclic.set_output_data(1, self.arguments.subslot, stw1.to_bytes(2, "big") + setpoint.to_bytes(2, "big", signed=True))

    def until(self, what, condition, seconds=5.0):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            zsw1, speed = self.inputs_now()
            if zsw1 is not None and condition(zsw1, speed):
                say("drive", what=what, zsw1=zsw1, speed=speed)
                return
            time.sleep(0.01)
        zsw1, speed = self.inputs_now()
        raise SystemExit(f"{what}: not reached, ZSW1 {zsw1 and hex(zsw1)}, speed {speed}, cyclic "
                         f"{self.cyclic.state.name} {self.errors} {self.statistics()}")

    def drive(self):
        """S2 by 0x047E, S4 by 0x047F, 60 rpm by setpoint 164, stop by OFF1, back to S2."""
        target = self.arguments.setpoint
        self.output(0x047E, 0)
        self.until("ready to switch on", lambda z, n: z & 0x0001 and not z & 0x0006 and not z & 0x0040)
        self.output(0x047F, 0)
        self.until("operation", lambda z, n: z & 0x0007 == 0x0007)
        self.output(0x047F, target)
        self.until("speed reached", lambda z, n: abs(n - target) <= 4, 10.0)
        time.sleep(1.0)
        zsw1, speed = self.inputs_now()
        say("drive", what="running", zsw1=zsw1, speed=speed)
        if abs(speed - target) > 8:
            raise SystemExit(f"speed not kept: {speed}")
        if self.arguments.job_running:
            for request in self.arguments.job_running:
                answer = self.job(bytes.fromhex(request), 0xB02E)
                say("record", index=0xB02E, request=request, answer=answer.hex(), running=True)
        self.output(0x047E, 0)
        self.until("stopped", lambda z, n: z & 0x0003 == 0x0001 and abs(n) <= 2, 10.0)

    def mirror(self):
        """Output to input round trip of a device that mirrors (slot 3 to slot 1, 64 octets)."""
        pattern = bytes(range(64))
        self.cyclic.set_output_data(3, 1, pattern)
        end = time.monotonic() + 3.0
        while time.monotonic() < end:
            if self.cyclic.get_input_data(1, 1) == pattern:
                say("mirror", ok=True)
                return
            time.sleep(0.01)
        raise SystemExit("output did not come back")

    def release(self):
        if self.cyclic is not None:
            self.cyclic.stop()
            self.cyclic = None
        self.device.disconnect()
        self.device.close()
        say("release", ok=True, states=self.states)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--interface", required=True)
    parser.add_argument("--mac", required=True)
    parser.add_argument("--name", required=True)
    parser.add_argument("--ip", required=True)
    parser.add_argument("--slots", default="")
    parser.add_argument("--gsdml", default="", help="device description to configure the slots from")
    parser.add_argument("--access-point", default="")
    parser.add_argument("--module", default="")
    parser.add_argument("--submodule", action="append", default=[])
    parser.add_argument("--ratio", type=int, default=32, help="cycle in milliseconds (a power of two)")
    parser.add_argument("--watchdog", type=int, default=6)
    parser.add_argument("--input-frame-id", type=lambda text: int(text, 0), default=0)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--setpoint", type=int, default=164)
    parser.add_argument("--job", action="append", default=[], help="parameter request in hexadecimal, sent to both records")
    parser.add_argument("--job-running", action="append", default=[], help="the same while the axis runs")
    parser.add_argument("--search-time", type=float, default=5.0, help="seconds that a search takes")
    parser.add_argument("--round", action="append", default=[], help="slots|output frames|parameter request, in hexadecimal")
    parser.add_argument("--hold", type=float, default=0.3, help="seconds that each frame of a round stands")
    parser.add_argument("--subslot", type=int, default=1, help="where in slot 1 the telegram is")
    parser.add_argument("--steps", required=True)
    arguments = parser.parse_args()
    if arguments.input_frame_id:
        choose_input_frame_id(arguments.input_frame_id)
    script = Script(arguments)
    for step in arguments.steps.split(","):
        getattr(script, step)()
    say("done")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
