"""view_client - a client of `leafcast view`: HTTP and WebSocket by sockets alone, as a browser speaks them.

    server = Server([leafcast, "view", "F.leaf"]); page = Page(server); page.view(1, {...}, 640, 360)
    head, picture = page.picture()
"""
import base64, contextlib, json, os, select, signal, socket, struct, subprocess, threading, time, urllib.parse, zlib


class Closed(Exception):
    """The other end has closed the connection; code: of WebSocket, or None."""

    def __init__(self, code=None):
        super().__init__(f"closed ({code})")
        self.code = code


class Server:
    def __init__(self, command, env=os.environ, **more):
        # What a shell begins in the background ignores SIGINT, and so would this.
        # ASan keeps what is freed, 256 MB of it, unless it is told: then memory tells nothing.
        env = dict(env, ASAN_OPTIONS=env.get("ASAN_OPTIONS", "") + ":quarantine_size_mb=8")
        self.process = subprocess.Popen(command, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), **more)
        self.url = self.process.stdout.readline().strip()
        parts = urllib.parse.urlsplit(self.url)
        if not parts.port:
            raise RuntimeError("no address: " + self.process.stderr.read())
        self.port = parts.port
        self.address, self.host = parts.hostname, parts.netloc
        self.token = urllib.parse.parse_qs(parts.query)["token"][0]

    def connect(self):
        return socket.create_connection((self.address, self.port), timeout=30)

    def get(self, target, host=None, method="GET", headers=()):
        """(status, headers, body) of one request."""
        with self.connect() as s:
            lines = [f"{method} {target} HTTP/1.1", f"Host: {host or self.host}", *headers,
                     "Connection: close", "", ""]
            s.sendall("\r\n".join(lines).encode("latin-1"))
            return read_answer(s)

    def stop(self, number=signal.SIGINT):
        """Its exit status, and what it said."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        _, said = self.process.communicate(timeout=60)
        return self.process.returncode, said

    def drawer(self):
        """The process that draws and serves: the child of the one that was started; None: there is none."""
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                parent = int(open(f"/proc/{pid}/stat").read().rsplit(")", 1)[1].split()[1])
            except OSError:
                continue
            if parent == self.process.pid:
                return int(pid)
        return None

    def cpu_seconds(self):
        fields = open(f"/proc/{self.drawer()}/stat").read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def rests(self):
        """Whether it comes to rest within a minute: there is a second in which it hardly works."""
        for _ in range(60):
            before = self.cpu_seconds()
            time.sleep(1.0)
            if self.cpu_seconds() - before < 0.3:
                return True
        return False


def read_answer(s):
    data = b""
    while b"\r\n\r\n" not in data:
        more = s.recv(65536)
        if not more:
            raise Closed()
        data += more
    head, body = data.split(b"\r\n\r\n", 1)
    lines = head.decode("latin-1").split("\r\n")
    headers = {k.strip().lower(): v.strip() for k, v in (l.split(":", 1) for l in lines[1:])}
    size = int(headers.get("content-length", "0"))
    while len(body) < size:
        more = s.recv(65536)
        if not more:
            raise Closed()
        body += more
    return int(lines[0].split()[1]), headers, body


class Page:
    """A WebSocket to a server, and what comes by it."""

    def __init__(self, server, token=None, origin=None, host=None, path="/socket"):
        token = server.token if token is None else token
        host = host or server.host
        self.socket = server.connect()
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.socket.sendall((f"GET {path}?token={token} HTTP/1.1\r\nHost: {host}\r\n"
                             f"Origin: {origin or 'http://' + host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                             f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}\r\n"
                             "Sec-WebSocket-Version: 13\r\n\r\n").encode())
        self.data = b""
        self.number = 0
        head = self.until(b"\r\n\r\n").decode("latin-1")
        self.status = int(head.split()[1])
        self.pictures = []
        self.volume = self.message()[1] if self.status == 101 else None

    def until(self, end):
        while end not in self.data:
            self.more()
        head, self.data = self.data.split(end, 1)
        return head

    def more(self):
        try:
            got = self.socket.recv(1 << 20)
        except ConnectionResetError:
            got = b""
        if not got:
            raise Closed()
        self.data += got

    def exactly(self, size):
        while len(self.data) < size:
            self.more()
        got, self.data = self.data[:size], self.data[size:]
        return got

    def send(self, payload, opcode=1, final=True, masked=True):
        if isinstance(payload, (dict, list)):
            payload = json.dumps(payload)
        if isinstance(payload, str):
            payload = payload.encode()
        size, bit = len(payload), 0x80 if masked else 0
        head = bytes([(0x80 if final else 0) | opcode])
        if size < 126:
            head += bytes([bit | size])
        elif size < 65536:
            head += bytes([bit | 126]) + struct.pack(">H", size)
        else:
            head += bytes([bit | 127]) + struct.pack(">Q", size)
        if masked:
            key = os.urandom(4)
            whole = int.from_bytes((key * (size // 4 + 1))[:size], "big")
            payload = key + (int.from_bytes(payload, "big") ^ whole).to_bytes(size, "big")
        try:
            self.socket.sendall(head + payload)
        except (BrokenPipeError, ConnectionResetError):
            raise Closed() from None

    def message(self, patient=True):
        """("text", object) or ("picture", (head, bytes)); answers pings, raises Closed. Impatient: also ("control", its
        number), such as a pong."""
        whole, kind = b"", None
        while True:
            first, second = self.exactly(2)
            size = second & 127
            if size == 126:
                size = struct.unpack(">H", self.exactly(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self.exactly(8))[0]
            payload = self.exactly(size)
            opcode = first & 15
            if opcode == 8:
                raise Closed(struct.unpack(">H", payload[:2])[0] if len(payload) >= 2 else None)
            if opcode == 9:
                self.send(payload, 10)
            if opcode > 2 and not patient:
                return "control", opcode
            if opcode > 2:
                continue
            kind = opcode or kind
            whole += payload
            if first & 0x80:
                break
        if kind == 1:
            return "text", json.loads(whole)
        length = struct.unpack("<I", whole[:4])[0]
        return "picture", (json.loads(whole[4:4 + length]), whole[4 + length:])

    def view(self, number, state, width, height, moving=False, where=False):
        self.number = number
        self.send({"type": "view", "number": number, "state": state, "width": width, "height": height,
                   "moving": moving, "where": where})

    def seen(self, head):
        self.send({"type": "seen", "number": head["number"], "part": head["part"]})

    def text(self, kind):
        """The next text of this type; pictures on the way are seen, and kept."""
        while True:
            what, got = self.message()
            if what == "picture":
                self.seen(got[0])
                self.pictures.append(got)
            elif got["type"] == kind:
                return got

    def picture(self):
        """The next picture, seen at once."""
        if self.pictures:
            return self.pictures.pop(0)
        while True:
            what, got = self.message()
            if what == "picture":
                self.seen(got[0])
                return got
            if got["type"] == "refused":
                raise RuntimeError(got["why"])

    def final(self):
        """All pictures to the last one of the newest view."""
        got = [self.picture()]
        while not (got[-1][0]["final"] and got[-1][0]["number"] == self.number):
            got.append(self.picture())
        return got

    def waits(self, seconds):
        """Whether something comes within so long."""
        return bool(self.data) or bool(select.select([self.socket], [], [], seconds)[0])

    @contextlib.contextmanager
    def kept(self):
        """Answers pings meanwhile, as a browser's page does: the server hangs up on one that is silent too long. What
        else comes is dropped."""
        over = threading.Event()

        def answer():
            while not over.is_set():
                if self.waits(0.1):
                    self.message(patient=False)

        thread = threading.Thread(target=answer)
        thread.start()
        try:
            yield
        finally:
            over.set()
            thread.join()

    def close(self):
        self.socket.close()


def png_pixels(data):
    """(width, height, channels, rows without filters) of an 8 bit PNG."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG"
    at, packed, size = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0]
        if kind == b"IHDR":
            size = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    width, height, depth, colour = size[:4]
    assert depth == 8 and colour in (2, 6), "RGB or RGBA of 8 bits"
    channels = 3 if colour == 2 else 4
    raw, stride = zlib.decompress(packed), width * channels
    rows, above = [], bytes(stride)
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        if kind == 2:
            row = bytearray((a + b) & 255 for a, b in zip(row, above))
        else:
            assert kind == 0, "filters none and up are what leafcast writes"
        rows.append(bytes(row))
        above = row
    return width, height, channels, b"".join(rows)


# ---- What is told of it ----

def ok(name, good):
    print("ok" if good else "not", name, flush=True)


def ends(server, name, number=signal.SIGINT):
    """Whether it does, by the signal, and without a report."""
    code, said = server.stop(number)
    ok(f"{name}: ends by the signal ({code})", code == 128 + number)
    ok(f"{name}: no report of a sanitizer", "Sanitizer" not in said and "runtime error" not in said)
    if "Sanitizer" in said:
        print(said)
