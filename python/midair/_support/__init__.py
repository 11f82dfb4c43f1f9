"""Support: functions of many packages."""
