# SPDX-License-Identifier: Apache-2.0
"""A real nginx with DAV on loopback, as the plain HTTP store of a remote cache."""

import os
import shutil
import socket
import subprocess
import tempfile
import time
import unittest
import urllib.request

NGINX = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin:/sbin")
TOKEN = "let-me-in"
# The bodies lie beside the store, so that a PUT is a rename.
CONFIGURATION = """
daemon off;
master_process off;
pid {folder}/nginx.pid;
error_log {folder}/error.log;
events {{}}
http {{
  access_log {folder}/access.log;
  client_body_temp_path {folder}/body;
  proxy_temp_path {folder}/unused; fastcgi_temp_path {folder}/unused;
  uwsgi_temp_path {folder}/unused; scgi_temp_path {folder}/unused;
  server {{
    listen 127.0.0.1:{port};
    root {folder}/store;
    client_max_body_size 64m;
    location /open/ {{ dav_methods PUT; create_full_put_path on; }}
    location /locked/ {{
      if ($http_authorization != "Bearer {token}") {{ return 401; }}
      dav_methods PUT; create_full_put_path on;
    }}
    location /readable/ {{
      limit_except GET {{ deny all; }}
    }}
    location /broken/ {{ return 500; }}
    location = /mark {{ access_log off; return 204; }}
  }}
}}
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class DavServer:
    """Runs until `stop`. Its store is a folder that tests may look into, and spoil."""

    def __init__(self):
        self.folder = tempfile.mkdtemp(prefix="spm-e2e-dav-")
        for name in ("open", "locked", "readable"):
            os.makedirs(os.path.join(self.folder, "store", name))
        self.port = free_port()
        configuration = os.path.join(self.folder, "nginx.conf")
        with open(configuration, "w", encoding="utf-8") as file:
            file.write(CONFIGURATION.format(folder=self.folder, port=self.port, token=TOKEN))
        self.log = os.path.join(self.folder, "access.log")
        self.process = subprocess.Popen(
            [NGINX, "-p", self.folder, "-c", configuration, "-e",
             os.path.join(self.folder, "error.log")],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.wait_until_up()

    def wait_until_up(self):
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                socket.create_connection(("127.0.0.1", self.port), timeout=1).close()
                return
            except OSError:
                time.sleep(0.02)
        with open(os.path.join(self.folder, "error.log"), encoding="utf-8") as file:
            why = file.read()
        self.stop()
        raise AssertionError("nginx does not answer: " + why)

    def stop(self):
        self.process.kill()
        self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def url(self, name="open"):
        return f"http://127.0.0.1:{self.port}/{name}"

    def store(self, name="open"):
        return os.path.join(self.folder, "store", name)

    def entries(self, name="open"):
        return [os.path.join(self.store(name), key) for key in sorted(os.listdir(self.store(name)))]

    def requests(self):
        """The methods that were asked for so far, in their order. The server, a single process, writes
        its log after it has answered, but before it answers the next request."""
        urllib.request.urlopen(f"http://127.0.0.1:{self.port}/mark", timeout=20).close()
        with open(self.log, encoding="utf-8") as file:
            return [line.split('"')[1].split()[0] for line in file]


def needs_nginx(case):
    return unittest.skipUnless(NGINX, "nginx is not installed; scripts/setup test brings it")(case)
