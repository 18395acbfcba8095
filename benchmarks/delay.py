"""A network that takes its time: a proxy on this machine that hands on every byte so much later."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from urllib.parse import urlsplit, urlunsplit

_CHUNK = 1 << 16  # bytes read at a time


@contextmanager
def delayed(address: str, seconds: float) -> Iterator[str]:
    """The address under which a server of this machine answers as from afar.

    Parameters
    ----------
    address : str
        Of the server, with its port; with no delay it is given back.
    seconds : float
        That each byte takes more, each way.
    """
    if not seconds:
        yield address
        return
    parts = urlsplit(address)
    opened: Future[tuple[asyncio.AbstractEventLoop, asyncio.Event, int]] = Future()

    async def connect(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        there, back = await asyncio.open_connection(parts.hostname, parts.port)
        with suppress(asyncio.CancelledError):  # at the end, when connections may still be open
            await asyncio.gather(_hand_on(reader, back, seconds), _hand_on(there, writer, seconds))

    async def serve() -> None:
        server, done = await asyncio.start_server(connect, "127.0.0.1", 0), asyncio.Event()
        opened.set_result((asyncio.get_running_loop(), done, server.sockets[0].getsockname()[1]))
        await done.wait()

    thread = threading.Thread(target=lambda: asyncio.run(serve()), daemon=True)
    thread.start()
    loop, done, port = opened.result(timeout=10)
    try:
        yield urlunsplit(parts._replace(netloc=f"127.0.0.1:{port}"))
    finally:
        loop.call_soon_threadsafe(done.set)
        thread.join()


async def _hand_on(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, seconds: float) -> None:
    """Write what is read, later; nothing waits for what came before it beyond its own time."""
    loop = asyncio.get_running_loop()
    queue: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue()

    async def read() -> None:
        with suppress(ConnectionError):
            while data := await reader.read(_CHUNK):
                queue.put_nowait((loop.time() + seconds, data))
        queue.put_nowait((loop.time() + seconds, b""))

    async def write() -> None:
        with suppress(ConnectionError):
            while True:
                due, data = await queue.get()
                await asyncio.sleep(max(0.0, due - loop.time()))
                if not data:
                    break
                writer.write(data)
                await writer.drain()
        writer.close()

    await asyncio.gather(read(), write())
