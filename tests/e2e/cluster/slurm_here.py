# SPDX-License-Identifier: Apache-2.0
"""A Slurm of one node on this machine, for a test alone: keys, sockets, ports and state of its own."""

import os
import secrets
import socket
import subprocess
import time

CONFIGURATION = """
ClusterName=spm
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
CredType=cred/munge
SlurmctldPort={controller}
SlurmdPort={node}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
JobAcctGatherType=jobacct_gather/none
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class SlurmHere:
    """Runs until `stop`. `environment` is what its commands need."""

    def __init__(self, folder):
        self.folder, self.processes = folder, []
        for name in ("munge", "state", "spool"):
            os.makedirs(os.path.join(folder, name), mode=0o755)
        key = os.path.join(folder, "munge", "key")
        with open(os.open(key, os.O_WRONLY | os.O_CREAT, 0o400), "wb") as file:
            file.write(secrets.token_bytes(128))
        self.host = socket.gethostname().split(".")[0]
        configuration = os.path.join(folder, "slurm.conf")
        with open(configuration, "w", encoding="utf-8") as file:
            file.write(CONFIGURATION.format(folder=folder, host=self.host, cores=os.cpu_count(),
                                            controller=free_port(), node=free_port()))
        self.environment = {**os.environ, "SLURM_CONF": configuration}
        munge = os.path.join(folder, "munge")
        self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={munge}/socket",
                   f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed")
        self.wait_for(lambda: os.path.exists(f"{munge}/socket"), "munged")
        self.start("slurmctld", "-D", "-i", "-f", configuration)
        self.start("slurmd", "-D", "-N", self.host, "-f", configuration)
        self.wait_for(self.idle, "slurmd")

    def start(self, *command):
        self.processes.append(subprocess.Popen(command, env=self.environment, stdout=subprocess.DEVNULL,
                                               stderr=subprocess.DEVNULL))

    def idle(self):
        shown = subprocess.run(["sinfo", "-h", "-o", "%t"], env=self.environment, capture_output=True,
                               text=True, check=False).stdout
        return shown.strip() == "idle"

    def wait_for(self, ready, name):
        deadline = time.monotonic() + 60
        while not ready():
            if time.monotonic() > deadline:
                self.stop()
                raise AssertionError(f"{name} did not come up; its log is in {self.folder}")
            time.sleep(0.1)

    def stop(self):
        for process in reversed(self.processes):
            process.terminate()
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self.processes = []
