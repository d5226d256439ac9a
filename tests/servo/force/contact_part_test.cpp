// SPDX-License-Identifier: Apache-2.0
#include "servo/force/contact_part.hpp"

#include <catch2/catch.hpp>

namespace contact_part_test {

using namespace spm;

TEST_CASE("Without applications all that was sent is the contact's, bit by bit") {
  const Vector3 sent(0.1, 0.2, 0.3);
  CHECK(contact_part(sent, {1, 2, 3}, Vector3::Zero()) == sent);
}

TEST_CASE("What applications push is none of the contact's, and a limit takes from both alike") {
  const Vector3 contact(0, 0, 2), added(3, 0, 0);
  CHECK(contact_part(contact + added, contact, added) == contact);
  CHECK(contact_part(0.5 * (contact + added), contact, added).isApprox(0.5 * contact));
  CHECK(contact_part(Vector3::Zero(), contact, added).isZero());
  CHECK(contact_part(added, Vector3::Zero(), added).isZero());
  // Two that cancel each other: nothing is sent, and the contact did its part.
  CHECK(contact_part(Vector3::Zero(), contact, -contact) == contact);
}

}  // namespace contact_part_test
