"""Threads, interrupts, processes."""
import os
import signal
import sys
import threading
import time

import pytest

import wisp

LARGE = {
    "steps": 100000,
    "surfaces": [
        {"name": "sheet", "generate": {"shape": "plane", "columns": 120, "rows": 120, "spacing": 0.01}, "pins": [0, 119], "cloth": {}}
    ],
}


@pytest.fixture
def large():
    with wisp.Scene.from_dict(LARGE).create_world(workers=1) as world:
        yield world


def in_thread(function):
    """Run a function in a thread. Returns what it raised."""
    raised = []

    def call():
        try:
            function()
        except BaseException as error:
            raised.append(error)

    thread = threading.Thread(target=call)
    thread.start()
    return thread, raised


def test_a_world_in_use_by_a_thread_refuses_another(large):
    go_on, made = True, 0

    def work():
        nonlocal made
        while go_on:
            try:
                large.step()
                made += 1
            except wisp.Conflict:  # the other thread was first
                pass

    thread, raised = in_thread(work)
    refused = 0
    deadline = time.monotonic() + 60
    while (refused < 50 or made < 3) and time.monotonic() < deadline:
        for call in (large.step, large.hash, large.snapshot, lambda: large.points("sheet"), lambda: large.set_gravity([0, -1, 0])):
            try:
                call()
            except wisp.Conflict as error:
                assert "the world is in use" in str(error)
                refused += 1
    go_on = False
    thread.join()
    assert refused >= 50 and made >= 3 and raised == []
    large.step()


def test_a_world_in_use_cannot_be_closed(large):
    started, go_on = threading.Event(), True

    def step(world):
        started.set()
        return go_on

    thread, raised = in_thread(lambda: large.run(callback=step))
    started.wait()
    closed = False
    for _ in range(200):
        try:
            large.close()
            closed = True
            break
        except wisp.Conflict:
            time.sleep(0.001)
    go_on = False
    thread.join()
    # Closed between two steps, the run ends with an exception; in a step, close() was refused.
    assert closed == large.closed
    assert all(isinstance(error, wisp.Conflict) for error in raised)


def test_a_world_may_go_from_one_thread_to_the_next(sheet):
    with sheet.create_world() as world, sheet.create_world() as other:
        for _ in range(4):
            thread, raised = in_thread(lambda: world.run(5))
            thread.join()
            assert raised == []
        other.run(20)
        assert world.hash() == other.hash()


def test_worlds_of_many_threads_step_at_once(sheet):
    hashes, lock = [], threading.Lock()

    def work():
        for _ in range(3):
            with sheet.create_world(workers=2) as world:
                world.run()
                with lock:
                    hashes.append(world.hash())

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(hashes) == 24 and len(set(hashes)) == 1


def test_other_threads_run_during_a_step(large):
    """One step is one call into the engine; without the interpreter's lock this thread counts meanwhile."""
    ticks, stepping, done = 0, threading.Event(), threading.Event()

    def work():
        stepping.set()
        large.advance(8 * large.scene.dt)  # a single call
        done.set()

    interval = sys.getswitchinterval()
    thread = threading.Thread(target=work)
    thread.start()
    stepping.wait()
    while not done.is_set():
        ticks += 1
    thread.join()
    assert ticks > 1000 and interval > 0


def test_an_interrupt_ends_a_run_between_two_steps(large):
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        large.run()
    count = large.step_count
    assert 0 < count < LARGE["steps"]
    large.step()
    assert large.step_count == count + 1


def test_interrupts_at_any_place_leave_a_world_that_goes_on(sheet):
    """Hundreds of interrupts, most of them in Python's own code around a short call."""
    count, inside = 0, False

    def interrupt(number, frame):
        nonlocal count, inside
        if inside:  # one for each round
            inside = False
            count += 1
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.002, 0.002)
    deadline = time.monotonic() + 20
    try:
        with sheet.create_world(workers=1) as world:
            while count < 300 and time.monotonic() < deadline:
                try:
                    inside = True
                    while True:
                        world.hash()
                        world.points("sheet")
                        world.set_gravity([0, -9.8, 0])
                        world.step()
                except KeyboardInterrupt:
                    pass
            steps = world.step_count
            world.step()
            assert count >= 50 and world.step_count == steps + 1
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_an_interrupt_ends_a_search(sheet):
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        # The reference alone takes minutes.
        wisp.tune(wisp.Scene.from_dict(LARGE), error=1e-9, length=20, limit=600)
    assert time.monotonic() - start < 60


def test_a_message_cannot_call_the_world_that_logs_it(sheet):
    import logging

    raised = []

    class Curious(logging.Handler):
        def handle(self, record):
            try:
                world.hash()
            except wisp.Conflict as error:
                raised.append(str(error))

    handler = Curious()
    logging.getLogger("wisp").addHandler(handler)
    try:
        with sheet.create_world() as world:
            world.unpin("sheet", [0, 8])
            world.set_gravity([0, 1e6, 0])
            world.run(150)
    finally:
        logging.getLogger("wisp").removeHandler(handler)
    assert raised and "the world is in use" in raised[0]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_world_goes_on_in_a_child_process(sheet):
    world = sheet.create_world(workers=2)
    world.run(5)
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        status = 1
        try:
            world.run(5)
            os.write(write, world.hash().encode())
            world.close()
            status = 0
        finally:
            os._exit(status)
    world.run(5)
    assert os.waitpid(child, 0)[1] == 0
    assert os.read(read, 16).decode() == world.hash()
    os.close(read)
    os.close(write)
    world.close()
