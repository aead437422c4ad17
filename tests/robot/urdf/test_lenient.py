"""Forms of XML that Pinocchio and MuJoCo read are read; numbers stay strict; messages state the line."""

from __future__ import annotations

import codecs
import time
import warnings

import numpy as np
import pytest

import robotraj as rt

BODY = (
    '<link name="a"/><link name="b"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" '
    'iyz="0"/></inertial></link><joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>'
    '<limit lower="-1" upper="1" velocity="2" effort="9"/></joint>'
)
ROBOT = f'<robot name="r">{BODY}</robot>'
XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'

READ = {
    "prefix of an attribute without declaration": ROBOT.replace('effort="9"', 'effort="9" sim:x="1"'),
    "prefix of an element without declaration": ROBOT.replace("</robot>", "<gazebo><sensor:camera/></gazebo></robot>"),
    "blank line before the declaration": f'\n <?xml version="1.0"?>\n{ROBOT}',
    "comment before the declaration": f'<!-- by hand --><?xml version="1.0"?>{ROBOT}',
    "hyphens in a comment": ROBOT.replace("<link", "<!-- -- base -- -- --><link", 1),
    "second top element": f"{ROBOT}<gazebo/>",
    "text after the end": f"{ROBOT}\nend\n",
    "ampersand": ROBOT.replace('name="r"', 'name="r & d"'),
    "default namespace": ROBOT.replace("<robot ", '<robot xmlns="http://www.ros.org" '),
    "unused namespace of xacro": ROBOT.replace("<robot ", f"<robot {XACRO} "),
    "unused definitions of xacro": ROBOT.replace(
        '<robot name="r">',
        f'<robot name="r" {XACRO}><xacro:property name="x" value="1"/>'
        '<xacro:macro name="m" params="y"><link name="${y}"/></xacro:macro>',
    ),
    "calls of macros that xacro left": ROBOT.replace("</robot>", '<xacro:sensors pose="${x}"/></robot>'),
    "no name": ROBOT.replace(' name="r"', "", 1),
    "version 1.1": f'<?xml version="1.1"?>{ROBOT}',
    "document type": f'<?xml version="1.0"?><!DOCTYPE robot>{ROBOT}',
    "carriage returns": ROBOT.replace("><", ">\r\n\t<"),
    "byte order mark": codecs.BOM_UTF8 + ROBOT.encode(),
    "UTF-16": codecs.BOM_UTF16_LE + ROBOT.encode("utf-16-le"),
    "GB 2312": '<?xml version="1.0" encoding="gb2312"?><!-- 机器人 -->'.encode("gb2312") + ROBOT.encode(),
    "Latin-1 declared as UTF-8": '<?xml version="1.0" encoding="utf-8"?><!-- é -->'.encode("latin-1") + ROBOT.encode(),
    "an encoding that does not exist": f'<?xml version="1.0" encoding="utf-88"?>{ROBOT}',
}


@pytest.mark.parametrize("form", READ)
def test_forms_that_other_readers_accept_are_read(form, tmp_path):
    text = READ[form]
    path = tmp_path / "robot.urdf"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = rt.load(path)
    np.testing.assert_array_equal([robot.limits.position_upper[0], robot.limits.velocity[0], robot.mass], [1, 2, 1])
    assert robot.visual_model.ngeoms == 0


def test_calls_of_macros_without_a_definition_are_named(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text(READ["calls of macros that xacro left"], encoding="utf-8")
    with pytest.warns(UserWarning, match="does not define are left out: <xacro:sensors>"):
        rt.load(path)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        (ROBOT[:-3], "line 1"),
        ("\n<!-- two\nlines -->\n" + ROBOT.replace("</joint>", ""), "line 4"),
        (ROBOT.replace("<link", "<!-- open <link", 1), "well-formed"),
        (ROBOT.replace('name="r"', 'name="&unknown;"'), "undefined entity"),
        ("", "no element"),
        ("words", "well-formed"),
    ],
)
def test_what_is_no_urdf_is_refused(text, part, tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(rt.InputError, match=part):
        rt.load(path)


@pytest.mark.parametrize("text", ["<!--" * 500_000, "&a" * 500_000, "<?xml " * 500_000, "<a>" * 200_000])
def test_long_files_of_nonsense_end_soon(text, tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    begun = time.process_time()
    with pytest.raises(rt.InputError):
        rt.load(path)
    assert time.process_time() - begun < 2.0
