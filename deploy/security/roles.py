# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Topics that each role writes and reads, as the documents that DDS Security 1.1 signs: governance and permissions."""

from xml.sax.saxutils import escape

SCHEMA = "http://www.omg.org/spec/DDS-SECURITY/20170901/"
EVERYBODY = ("echo_question", "echo_answer")
SERVER = ("session_description", "scene", "proxy", "tissue_contacts", "tube_force", "deformation", "deformation_slow",
          "fluid", "particle_state", "mesh_state", "command_result", "live_metrics", "attempt_summary",
          "shown_annotation", "session_status")

TOOLS = ("laryngoscope_pose", "tube_pose")

# Topics that each role writes, in addition to everybody's. The server reads all topics, others the server's: readers of
# commands that do not acknowledge them could block the writer.
WRITES = {
    "server": SERVER,
    "trainee": ("eye_pose", "command"),
    "hands": ("eye_pose", "command", *TOOLS),
    "instructor": ("command", "annotation"),
    "laryngoscope": ("laryngoscope_pose",),
    "tube": ("tube_pose",),
    "observer": ("annotation",),
}
DOES = {
    "server": "simulates, judges, records",
    "trainee": "the trainee's client: sends commands, publishes the eye position",
    "hands": "the same, with tools controlled by mouse and keys (eti-client --hands)",
    "instructor": "sends commands, adds remarks",
    "laryngoscope": "the device that holds the laryngoscope",
    "tube": "the device or tracker that holds the tube",
    "observer": "watches, adds remarks",
}


def reads(role):
    if role == "server":
        return tuple(dict.fromkeys(topic for topics in WRITES.values() for topic in topics)) + EVERYBODY
    # Role `hands` reads whether a device already holds a tool.
    return SERVER + EVERYBODY + (TOOLS if role == "hands" else ())


def governance(authority):
    """No access without an identity, everything encrypted, writing and reading by permissions. Not whole datagrams
    (rtps_protection_kind): with that, Fast DDS 2.9.1 aborts or stalls when members join and leave."""
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<!-- {escape(authority)} -->
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="{SCHEMA}omg_shared_ca_governance.xsd">
  <domain_access_rules>
    <domain_rule>
      <domains><id_range><min>0</min><max>232</max></id_range></domains>
      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
      <rtps_protection_kind>NONE</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>ENCRYPT</metadata_protection_kind>
          <data_protection_kind>NONE</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
"""


def _criteria(kind, topics, partitions):
    return (f"<{kind}><topics>" + "".join(f"<topic>eti/{escape(topic)}</topic>" for topic in topics) +
            "</topics><partitions>" + "".join(f"<partition>{escape(name)}</partition>" for name in partitions) +
            f"</partitions></{kind}>\n")


def permissions(role, name, subject, valid_from, valid_to, sessions, domains):
    """Permissions of one identity. `subject` as in RFC 2253; `sessions` empty: all; `domains`: (first, last). A
    session's partition is its name, a slash and the protocol version; permissions are valid for any version. Without
    indentation: the document must fit one datagram."""
    partitions = [f"{session}/*" for session in sessions] or ["*"]
    moment = "%Y-%m-%dT%H:%M:%S"
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
xsi:noNamespaceSchemaLocation="{SCHEMA}omg_shared_ca_permissions.xsd">
<permissions><grant name="{escape(name)}"><subject_name>{escape(subject)}</subject_name>
<validity><not_before>{valid_from:{moment}}</not_before><not_after>{valid_to:{moment}}</not_after></validity>
<allow_rule><domains><id_range><min>{domains[0]}</min><max>{domains[1]}</max></id_range></domains>
{_criteria("publish", WRITES[role] + EVERYBODY, partitions)}{_criteria("subscribe", reads(role), partitions)}</allow_rule>
<default>DENY</default></grant></permissions></dds>
"""
