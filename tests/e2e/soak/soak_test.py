#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The short form of replug.py, applications.py, away.py, presses.py and restarts.py. No time decides a
test, only what happened."""

import os
import sys
import unittest

import applications
import away
import hostile
import presses
import replug
import restarts
from soak_tools import Folder, Row
from stalls import Stall, explained

CYCLES, ROUNDS, TIMES = 5, 20, 3
SESSIONS = 3
PRESSES, KILLS = 2, 2
STREAMS = ("far_60", "added_60")
MOST_WORK = 2e-3  # J; two presses by themselves give 0.2 mJ, and streams once gave 5 mJ and more


class Replug(unittest.TestCase):
    def check(self, name: str) -> None:
        with Folder() as folder:
            run = replug.run_cycles(name, CYCLES, None, folder)
        outages = replug.outages(run["rows"])
        recovered = [end for _, end in outages if end is not None]
        self.assertGreaterEqual(len(recovered), CYCLES, outages)
        self.assertGreaterEqual(run["device"]["unplugged"], CYCLES)
        self.assertGreaterEqual(run["report"]["devices"][0]["reopened"], CYCLES)
        self.assertEqual(replug.force_while_off(run["rows"]), 0)
        # There was a force to lose, and it came back.
        for begin, (end, _) in zip((0, *recovered), outages):
            self.assertGreater(max(row.size for row in run["rows"][begin:end]), 0)
        for begin, end in outages:
            off = run["rows"][begin:end]
            self.assertEqual({row.size for row in off}, {0.0})

    def test_an_unplugged_woodenhaptics_gets_no_force_and_is_taken_up_each_time(self) -> None:
        self.check("woodenhaptics")

    def test_an_unplugged_falcon_gets_no_force_and_is_taken_up_each_time(self) -> None:
        self.check("falcon")


class Stalls(unittest.TestCase):
    """Ticks of 1 ms from 0 on, of which the second is lost."""

    def explained(self, wake_us: float, busy_us: float, *stalls: tuple[float, float],
                  earlier_us: float = 0) -> int:
        rows = [Row(tick, 0.0, int(wake * 1e3), int(busy * 1e3), "none", True, False)
                for tick, wake, busy in ((0, 10, 200), (1, wake_us, busy_us), (3, 10, 200))]
        return explained(rows, 0.0, 1000, [Stall(begin * 1e3, end * 1e3) for begin, end in stalls],
                         earlier_us * 1e3)

    def test_a_stall_before_the_loop_woke_explains_the_two_ticks_that_it_cost(self) -> None:
        self.assertEqual(self.explained(900, 200, (1100, 1850)), 2)

    def test_so_does_one_in_the_tick_s_work(self) -> None:
        self.assertEqual(self.explained(10, 1100, (1300, 1600)), 2)

    def test_one_at_another_time_explains_nothing(self) -> None:
        self.assertEqual(self.explained(900, 200, (100, 850), (2150, 2900)), 0)

    def test_nor_does_one_without_which_the_tick_would_have_been_late_all_the_same(self) -> None:
        self.assertEqual(self.explained(10, 1700, (1300, 1900)), 0)

    def test_stalls_that_overlap_count_once(self) -> None:
        self.assertEqual(self.explained(10, 1500, (1200, 1500), (1200, 1500)), 0)
        self.assertEqual(self.explained(10, 1500, (1200, 1500), (1500, 1800)), 2)

    def test_one_that_may_have_begun_before_it_was_seen_may_explain_more(self) -> None:
        self.assertEqual(self.explained(10, 1300, (1300, 1500)), 0)
        self.assertEqual(self.explained(10, 1300, (1300, 1500), earlier_us=200), 2)


class Applications(unittest.TestCase):
    def test_the_daemon_and_honest_applications_outlive_hostile_ones(self) -> None:
        with Folder() as folder:
            run = applications.Run(folder, None, seed=1)
            try:
                self.assertEqual(run.check(), [])
                applications.attack(run, ROUNDS)
                self.assertEqual(run.check(), [])
                done = run.rounds.done
                failures = [run.readers.noted(place)[1] for place in range(applications.READERS)]
            finally:
                report = run.end()
        self.assertEqual(done["rounds"], ROUNDS)
        self.assertGreater(done["connected"], ROUNDS)
        for kind in hostile.KINDS:
            self.assertGreater(done[kind], 0)
        self.assertLess(max(failures), report["ticks"])


class Away(unittest.TestCase):
    """Each asks that the force went off while the daemon was away, not when."""

    def check(self, kind: str) -> None:
        if reason := away.why_not(kind):
            self.skipTest(reason)
        core = max(os.sched_getaffinity(0))
        heard = []
        for _ in range(SESSIONS):
            events, seen, _ = away.run_session(kind, TIMES, core=core)
            self.assertEqual(len(events), TIMES)
            self.assertEqual(seen["last_mA"], [0, 0, 0])
            self.assertEqual(seen["wrong_commands"], 0)
            # What the emulation did not hear tells nothing.
            heard += [event for event in events if away.counts(event)]
            if heard:
                break
        self.assertTrue(heard, "the emulation heard nothing of any event")
        for event in heard:
            self.assertLess(event["off_ms"], away.AWAY * 1e3, events)

    def test_a_stopped_daemon_s_force_goes_off_while_it_is_stopped(self) -> None:
        self.check("stopped")

    def test_a_frozen_daemon_s_force_goes_off_while_it_is_frozen(self) -> None:
        self.check("frozen")

    def test_a_killed_daemon_s_force_goes_off(self) -> None:
        self.check("killed")

    def test_force_goes_off_while_a_process_of_the_highest_priority_has_the_loop_s_core(self) -> None:
        self.check("starved")

    def test_force_goes_off_while_the_loop_spins_on_the_core_of_its_guards(self) -> None:
        self.check("spinning")


class Presses(unittest.TestCase):
    def test_no_stream_of_commands_drives_a_hand(self) -> None:
        for stream in (one for one in presses.STREAMS if one.name in STREAMS):
            with self.subTest(stream.name):
                run = presses.run_stream(stream, PRESSES)
                self.assertEqual(run["presses"], PRESSES)
                self.assertEqual(run["refused"], 0, run["refusal"])
                self.assertGreater(run["taken"], PRESSES)
                self.assertLess(run["generated_max_j"], MOST_WORK)

    def test_presses_are_counted_by_a_force_that_came_and_went(self) -> None:
        self.assertEqual(presses.presses_of([0, 2, 0.5, 2, 0, 0.5, 0, 1.5]), 2)


class Restarts(unittest.TestCase):
    def test_an_application_is_told_of_each_kill_and_reads_force_of_the_next_daemon(self) -> None:
        run = restarts.run_kills(KILLS)
        self.assertEqual((run["lost_events"], run["found_events"]), (KILLS, KILLS))
        self.assertEqual(len(run["half_force_ms"]), KILLS)


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
