// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/devices/hid/mock_hid_bus.hpp"

#include <fcntl.h>
#include <linux/hidraw.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>

namespace spm::test {

namespace {

constexpr const char* usb_path = "/sys/devices/pci0000:00/0000:00:14.0/usb1/1-1";
constexpr const char* interface_path = "/sys/devices/pci0000:00/0000:00:14.0/usb1/1-1/1-1:1.0";

/// How many reports the kernel keeps until somebody fetches them; it drops those that come then.
constexpr std::size_t kept_reports = 64;

/// Numbers of the ioctls that exchange a report.
constexpr unsigned set_feature = _IOC_NR(HIDIOCSFEATURE(0));
constexpr unsigned get_feature = _IOC_NR(HIDIOCGFEATURE(0));
constexpr unsigned get_input = _IOC_NR(HIDIOCGINPUT(0));

constexpr bool is_exchange(unsigned number) {
  return number == set_feature || number == get_feature || number == get_input;
}

/// Bytes that a request's argument has; 0 where the device does not know it.
std::size_t answer_size(gulong request) {
  if (request == HIDIOCGRDESCSIZE) return sizeof(int);
  if (request == HIDIOCGRDESC) return sizeof(hidraw_report_descriptor);
  if (request == HIDIOCGRAWINFO) return sizeof(hidraw_devinfo);
  // The size of reports is part of the request.
  return _IOC_TYPE(request) == 'H' && is_exchange(_IOC_NR(request)) ? _IOC_SIZE(request) : 0;
}

[[noreturn]] void give_up(const char* why) {
  std::cerr << "mock_hid: " << why << '\n';
  std::exit(EXIT_FAILURE);
}

void check(const GError* error) {
  if (error != nullptr) give_up(error->message);
}

std::string hex(const HidBytes& bytes) {
  std::string text;
  std::array<char, 3> two{};
  for (const std::uint8_t byte : bytes) {
    std::snprintf(two.data(), two.size(), "%02X", byte);
    text += two.data();
  }
  return text;
}

std::string hex4(unsigned number, int digits = 4) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%0*X", digits, number);
  return text.data();
}

/// What /sys says of the device, in umockdev's notation.
std::string records(const HidIdentity& identity, const std::string& node) {
  const std::string vendor = hex4(identity.vendor), product = hex4(identity.product);
  const std::string hid_name = "0003:" + vendor + ":" + product + ".0001";
  const std::string usb = usb_path + std::strlen("/sys");
  const std::string interface = interface_path + std::strlen("/sys");
  const std::string hid = interface + "/" + hid_name;
  std::string text;
  text += "P: " + hid + "/hidraw/" + node + "\nN: " + node + "\nE: DEVNAME=/dev/" + node + "\n";
  text += "E: SUBSYSTEM=hidraw\nE: MAJOR=240\nE: MINOR=7\nL: device=../../../" + hid_name + "\n\n";
  text += "P: " + hid +
          "\nE: SUBSYSTEM=hid\nE: DRIVER=hid-generic\nE: HID_ID=0003:" + hex4(identity.vendor, 8) +
          ":" + hex4(identity.product, 8) + "\nE: HID_NAME=" + identity.name +
          "\nE: HID_UNIQ=" + identity.serial + "\nE: HID_PHYS=usb-0000:00:14.0-1/input0\n";
  text += "H: report_descriptor=" + hex(identity.descriptor) + "\n\n";
  text += "P: " + interface + "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nE: DRIVER=usbhid\n";
  text += "A: bInterfaceNumber=00\\n\nA: bInterfaceClass=03\\n\n\n";
  text += "P: " + usb + "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nA: idVendor=" + vendor +
          "\\n\nA: idProduct=" + product +
          "\\n\nA: manufacturer=Emulated\\n\nA: product=" + identity.name +
          "\\n\nA: bcdDevice=0001\\n\nA: busnum=1\\n\nA: devnum=2\\n\n";
  if (!identity.serial.empty()) text += "A: serial=" + identity.serial + "\\n\n";
  return text + "\n";
}

}  // namespace

MockHidBus::MockHidBus(std::unique_ptr<EmulatedHid> device, const HidFaults& faults)
    : device_(std::move(device)), faults_(faults), testbed_(umockdev_testbed_new()) {
  handler_ = umockdev_ioctl_base_new();
  g_signal_connect(handler_, "client-connected", G_CALLBACK(&MockHidBus::on_connected), this);
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&MockHidBus::on_ioctl), this);
  g_signal_connect(handler_, "handle-read", G_CALLBACK(&MockHidBus::on_read), this);
  g_signal_connect(handler_, "handle-write", G_CALLBACK(&MockHidBus::on_write), this);
  if (device_->period_ms() > 0) {
    g_timeout_add(static_cast<guint>(device_->period_ms()), &MockHidBus::on_period, this);
  }
}

MockHidBus::~MockHidBus() {
  unplug();
  g_object_unref(handler_);
  g_object_unref(testbed_);
}

void MockHidBus::plug_in() {
  {
    // umockdev cannot give a node's name twice; the kernel seldom does.
    const std::lock_guard lock(mutex_);
    ++generation_;
  }
  const std::string node = node_name();
  GError* error = nullptr;
  umockdev_testbed_add_from_string(testbed_, records(device_->identity(), node).c_str(), &error);
  check(error);
  const std::string path = "/dev/" + node;
  umockdev_testbed_attach_ioctl(testbed_, path.c_str(), handler_, &error);
  check(error);
  const std::lock_guard lock(mutex_);
  master_ = umockdev_testbed_get_dev_fd(testbed_, path.c_str());
  std::array<char, 64> name{};
  if (master_ < 0 || ptsname_r(master_, name.data(), name.size()) != 0) {
    give_up("the device has no terminal");
  }
  tokens_ = open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  plugged_in_ = true;
  powered_ = false;
  since_plug_in_ = 0;
}

void MockHidBus::unplug() {
  std::vector<UMockdevIoctlClient*> waiting;
  {
    const std::lock_guard lock(mutex_);
    if (!plugged_in_) return;
    plugged_in_ = false;
    queue_.clear();
    waiting.swap(waiting_);
    // Wakes whoever polls: the read that follows says that the device is gone.
    static_cast<void>(!write(master_, "x", 1));
    close(tokens_);
  }
  for (UMockdevIoctlClient* client : waiting) {
    umockdev_ioctl_client_complete(client, -1, ENODEV);
    g_object_unref(client);
  }
  GError* error = nullptr;
  umockdev_testbed_detach_ioctl(testbed_, ("/dev/" + node_name()).c_str(), &error);
  check(error);
  for (const std::string& path : sys_paths()) {
    umockdev_testbed_remove_device(testbed_, path.c_str());
  }
  // umockdev leaves the node behind.
  gchar* root = umockdev_testbed_get_root_dir(testbed_);
  static_cast<void>(unlink((std::string(root) + "/dev/" + node_name()).c_str()));
  g_free(root);
}

void MockHidBus::notify_at(int reports, std::function<void()> reached) {
  const std::lock_guard lock(mutex_);
  reached_at_ = reports;
  reached_ = std::move(reached);
}

nlohmann::ordered_json MockHidBus::seen() {
  const std::lock_guard lock(mutex_);
  nlohmann::ordered_json json = device_->seen();
  json["unplugged"] = unplugged_;
  json["dropped_reports"] = dropped_;
  json["refused_ns"] = refused_ns_;
  json["unplugged_ns"] = unplugged_ns_;
  json["plugged_in_ns"] = plugged_in_ns_;
  json["deaf_ns"] = listening_.deaf_ns();
  return json;
}

int MockHidBus::wrong() {
  const std::lock_guard lock(mutex_);
  return device_->wrong();
}

std::string MockHidBus::node_name() const { return "hidraw" + std::to_string(6 + generation_); }

/// The device's own paths, children first.
std::vector<std::string> MockHidBus::sys_paths() const {
  const HidIdentity identity = device_->identity();
  const std::string hid = std::string(interface_path) + "/0003:" + hex4(identity.vendor) + ":" +
                          hex4(identity.product) + ".0001";
  return {hid + "/hidraw/" + node_name(), hid, interface_path, usb_path};
}

void MockHidBus::queue(const std::vector<HidBytes>& reports) {
  for (HidBytes report : reports) {
    ++count_;
    ++since_plug_in_;
    if (reached_ && count_ == reached_at_) reached_();
    if (faults_.short_every > 0 && count_ % faults_.short_every == 0) report.pop_back();
    if (faults_.silent_after > 0 && count_ > faults_.silent_after && silent_until_ == 0) {
      silent_until_ = g_get_monotonic_time() + std::int64_t{faults_.silent_ms} * 1000;
    }
    if (is_silent()) {
      hold(report, static_cast<int>((silent_until_ - g_get_monotonic_time()) / 1000) + 1);
    } else if (faults_.late_every > 0 && count_ % faults_.late_every == 0) {
      hold(report, faults_.late_ms);
    } else {
      deliver(report);
    }
    if (faults_.unplug_after > 0 && since_plug_in_ == faults_.unplug_after) {
      ++unplugged_;
      g_idle_add(&MockHidBus::on_unplug, this);
    }
  }
}

void MockHidBus::deliver(const HidBytes& report) {
  if (queue_.size() >= kept_reports) {
    ++dropped_;
    return;
  }
  queue_.push_back(report);
  // poll is not emulated: it sees a terminal, in which lies a byte for each report.
  static_cast<void>(!write(master_, "x", 1));
  if (waiting_.empty()) return;
  UMockdevIoctlClient* client = waiting_.front();
  waiting_.erase(waiting_.begin());
  const long size = fetch(client);
  umockdev_ioctl_client_complete(client, size, 0);
  g_object_unref(client);
  queue(device_->taken());
}

void MockHidBus::drop_queued() {
  std::array<char, 1> token{};
  for (; !queue_.empty(); queue_.pop_front()) static_cast<void>(!read(tokens_, token.data(), 1));
}

void MockHidBus::hold(const HidBytes& report, int milliseconds) {
  g_timeout_add(static_cast<guint>(milliseconds), &MockHidBus::on_held,
                new Held{this, report, generation_});
}

/// Copies the oldest report into a client's buffer.
long MockHidBus::fetch(UMockdevIoctlClient* client) {
  std::array<char, 1> token{};
  static_cast<void>(!read(tokens_, token.data(), 1));
  const HidBytes report = queue_.front();
  queue_.pop_front();
  UMockdevIoctlData* data = umockdev_ioctl_client_get_arg(client);
  const auto room = static_cast<std::size_t>(data->data_len);
  const std::size_t size = std::min(report.size(), room);
  std::memcpy(data->data, report.data(), size);
  return static_cast<long>(size);
}

bool MockHidBus::is_present(UMockdevIoctlClient* client) const {
  return plugged_in_ &&
         GPOINTER_TO_INT(g_object_get_data(G_OBJECT(client), "generation")) == generation_;
}

bool MockHidBus::is_silent() const { return g_get_monotonic_time() < silent_until_; }

int MockHidBus::exchange(UMockdevIoctlClient* client, unsigned number, HidBytes& bytes,
                         int& error_number) {
  error_number = ENODEV;
  if (!is_present(client)) return -1;
  error_number = is_silent() ? ETIMEDOUT : EPIPE;
  if (is_silent() || bytes.empty()) return -1;
  if (number == set_feature) {
    return device_->feature_written(bytes) ? static_cast<int>(bytes.size()) : -1;
  }
  const auto answer =
      number == get_feature ? device_->feature_asked(bytes[0]) : device_->input_asked(bytes[0]);
  if (!answer) return -1;
  const std::size_t size = std::min(answer->size(), bytes.size());
  std::copy_n(answer->begin(), size, bytes.begin());
  return static_cast<int>(size);
}

void MockHidBus::on_connected(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  auto* bus = static_cast<MockHidBus*>(self);
  const std::lock_guard lock(bus->mutex_);
  bus->listening_.begin();
  g_object_set_data(G_OBJECT(client), "generation", GINT_TO_POINTER(bus->generation_));
  // What opens a node hears what comes from then on, as with the kernel. A board that answers would
  // wait for ever for its answer to be taken.
  if (bus->device_->period_ms() > 0) bus->drop_queued();
  if (bus->powered_) return;
  // It is asked for reports from its first opening on.
  bus->powered_ = true;
  bus->queue(bus->device_->plug_in());
}

gboolean MockHidBus::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  auto* bus = static_cast<MockHidBus*>(self);
  const HidIdentity identity = bus->device_->identity();
  const auto request = umockdev_ioctl_client_get_request(client);
  const auto number = static_cast<unsigned>(_IOC_NR(request));
  const std::size_t bytes_given = answer_size(request);
  if (bytes_given == 0) return FALSE;
  GError* error = nullptr;
  UMockdevIoctlData* data =
      umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, bytes_given, &error);
  if (data == nullptr) {
    // The program was killed while it waited.
    g_clear_error(&error);
    umockdev_ioctl_client_complete(client, -1, EIO);
    return TRUE;
  }
  if (request == HIDIOCGRDESCSIZE) {
    const int size = static_cast<int>(identity.descriptor.size());
    std::memcpy(data->data, &size, sizeof size);
  } else if (request == HIDIOCGRDESC) {
    hidraw_report_descriptor descriptor{};
    descriptor.size = static_cast<std::uint32_t>(identity.descriptor.size());
    std::memcpy(descriptor.value, identity.descriptor.data(), identity.descriptor.size());
    std::memcpy(data->data, &descriptor, sizeof descriptor);
  } else if (request == HIDIOCGRAWINFO) {
    hidraw_devinfo info{};
    info.bustype = 3;
    info.vendor = static_cast<std::int16_t>(identity.vendor);
    info.product = static_cast<std::int16_t>(identity.product);
    std::memcpy(data->data, &info, sizeof info);
  } else {
    HidBytes bytes(data->data, data->data + bytes_given);
    int result = 0, error_number = 0;
    {
      const std::lock_guard lock(bus->mutex_);
      result = bus->exchange(client, number, bytes, error_number);
    }
    std::memcpy(data->data, bytes.data(), bytes.size());
    umockdev_ioctl_client_complete(client, result, result < 0 ? error_number : 0);
    return TRUE;
  }
  umockdev_ioctl_client_complete(client, 0, 0);
  return TRUE;
}

gboolean MockHidBus::on_read(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  auto* bus = static_cast<MockHidBus*>(self);
  long size = -1;
  {
    const std::lock_guard lock(bus->mutex_);
    if (bus->is_present(client)) {
      if (bus->queue_.empty()) {
        bus->waiting_.push_back(static_cast<UMockdevIoctlClient*>(g_object_ref(client)));
        return TRUE;
      }
      size = bus->fetch(client);
      bus->queue(bus->device_->taken());
    }
  }
  umockdev_ioctl_client_complete(client, size, size < 0 ? ENODEV : 0);
  return TRUE;
}

gboolean MockHidBus::on_write(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  auto* bus = static_cast<MockHidBus*>(self);
  long size = -1;
  int error_number = ENODEV;
  {
    const std::lock_guard lock(bus->mutex_);
    const HidFaults& faults = bus->faults_;
    const int number = ++bus->written_ - faults.refused_write;
    if (faults.refused_write > 0 && number >= 0 && number < faults.refused_writes) {
      if (bus->refused_ns_ == 0) bus->refused_ns_ = g_get_monotonic_time() * 1000;
      error_number = EIO;
    } else if (bus->is_present(client)) {
      UMockdevIoctlData* data = umockdev_ioctl_client_get_arg(client);
      size = data->data_len;
      bus->queue(bus->device_->written(HidBytes(data->data, data->data + size)));
    }
  }
  umockdev_ioctl_client_complete(client, size, size < 0 ? error_number : 0);
  return TRUE;
}

gboolean MockHidBus::on_period(gpointer self) {
  auto* bus = static_cast<MockHidBus*>(self);
  const std::lock_guard lock(bus->mutex_);
  if (bus->plugged_in_ && bus->powered_) bus->queue(bus->device_->unasked());
  return G_SOURCE_CONTINUE;
}

gboolean MockHidBus::on_held(gpointer given) {
  const std::unique_ptr<Held> held(static_cast<Held*>(given));
  MockHidBus* bus = held->bus;
  const std::lock_guard lock(bus->mutex_);
  if (bus->plugged_in_ && held->generation == bus->generation_) bus->deliver(held->report);
  return G_SOURCE_REMOVE;
}

gboolean MockHidBus::on_unplug(gpointer self) {
  auto* bus = static_cast<MockHidBus*>(self);
  {
    const std::lock_guard lock(bus->mutex_);
    bus->unplugged_ns_.push_back(g_get_monotonic_time() * 1000);
  }
  bus->unplug();
  g_timeout_add(static_cast<guint>(bus->faults_.unplug_ms), &MockHidBus::on_plug_in, self);
  return G_SOURCE_REMOVE;
}

gboolean MockHidBus::on_plug_in(gpointer self) {
  auto* bus = static_cast<MockHidBus*>(self);
  bus->plug_in();
  const std::lock_guard lock(bus->mutex_);
  bus->plugged_in_ns_.push_back(g_get_monotonic_time() * 1000);
  return G_SOURCE_REMOVE;
}

}  // namespace spm::test
