// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "servo/commands/commands.hpp"
#include "servo/doctor/doctor.hpp"

namespace spm::servo {

namespace {

constexpr double shortest_look = 0.1;  // s
constexpr double longest_look = 20;    // s; the whole command ends within 30 s

struct DoctorCommand {
  cli::GlobalOptions global;
  double seconds = 10;
};

int execute_doctor(const DoctorCommand& command) {
  cli::configure_messages(command.global);
  Diagnosis diagnosis;
  {
    cli::ProgressLine line(command.global);
    diagnosis = diagnose(command.seconds,
                         [&line](double share) { line.update("measuring wake-ups", share); });
  }
  if (command.global.json) {
    cli::print_json(to_json(diagnosis));
  } else if (!command.global.quiet) {
    fmt::print("{}", to_text(diagnosis));
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace

Command add_doctor_command(CLI::App& program) {
  auto command = std::make_shared<DoctorCommand>();
  CLI::App* app = program.add_subcommand(
      "doctor", "Measure whether this machine is fit for a loop at 1 kHz, and say what to mend");
  cli::add_global_options(*app, command->global);
  add_number(*app, "--seconds", shortest_look, longest_look, command->seconds,
             "Measure wake-ups for so long, 0.1 to 20 (default 10)")
      ->type_name("SECONDS");
  return {app, [command] { return execute_doctor(*command); }};
}

}  // namespace spm::servo
