// SPDX-License-Identifier: Apache-2.0
#include "servo/client/last_error.hpp"

#include <array>
#include <cstdio>

#include "servo/client/spm_client.h"

namespace spm::servo {

namespace {

struct LastError {
  int code = SPM_CLIENT_OK;
  std::array<char, 256> sentence{};
};

LastError& last_error() noexcept {
  thread_local LastError error;
  return error;
}

/// What a code means where no call told more.
const char* text_of(int code) noexcept {
  switch (code) {
    case SPM_CLIENT_OK:
      return "nothing is wrong";
    case SPM_CLIENT_BAD_ARGUMENT:
      return "an argument is NULL, or a struct has the size of no version: set its size to sizeof";
    case SPM_CLIENT_NO_DAEMON:
      return "the daemon is gone: start 'spm-servo run', then connect again or let the client "
             "reconnect by itself";
    case SPM_CLIENT_REFUSED:
      return "the daemon does not want this application: its message says why";
    case SPM_CLIENT_INTERNAL:
      return "no memory, or a defect: report it";
    case SPM_CLIENT_VERSION_DIFFERS:
      return "daemon and library do not belong together: install both of the same version";
    case SPM_CLIENT_RING_FULL:
      return "the daemon has not yet come to earlier commands: try again in the next frame";
    case SPM_CLIENT_BUSY:
      return "the state changed under the reader too often: try again";
    case SPM_CLIENT_NOT_THERE:
      return "there is no such device, object, asset or cause, or no tick so far";
    case SPM_CLIENT_NOT_MOVABLE:
      return to_sentence(Refusal::not_movable);
    default:
      return "a code that this version does not know";
  }
}

}  // namespace

int failed(int code) noexcept { return failed(code, ""); }

int failed(int code, const char* sentence) noexcept {
  LastError& error = last_error();
  error.code = code;
  std::snprintf(error.sentence.data(), error.sentence.size(), "%s", sentence);
  return code;
}

int failed(int code, Refusal refusal, const WrongNumber& number) noexcept {
  if (number.name == nullptr) return failed(code, to_sentence(refusal));
  LastError& error = last_error();
  error.code = code;
  std::snprintf(error.sentence.data(), error.sentence.size(),
                "%s is %.6g: it has to be from %.6g to %.6g", number.name, number.value,
                number.least, number.most);
  return code;
}

}  // namespace spm::servo

const char* spm_client_text(int code) {
  const spm::servo::LastError& error = spm::servo::last_error();
  return error.code == code && error.sentence[0] != '\0' ? error.sentence.data()
                                                         : spm::servo::text_of(code);
}
