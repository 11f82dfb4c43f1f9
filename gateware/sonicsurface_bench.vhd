-- Two SonicSurface boards on one line: bytes in, pins out. Prints the pins at each change after the last byte.
library ieee, primary, secondary;
use ieee.std_logic_1164.all;
use std.textio.all;
use ieee.std_logic_textio.all;

entity bench is
    generic (bytes : string; offset : integer := 31; primary_taps, secondary_taps : integer);
end entity;

architecture simulated of bench is
    constant HALF : time := 48828125 fs;        -- half a period of 10.24 MHz
    constant BIT_TIME : time := 1 sec / 230400;
    signal clocks : std_logic_vector(0 to 1) := "00";
    signal serial : std_logic := '1';
    signal reset : std_logic;
    signal recorded : boolean := false;
    signal start : time;
    type boards is array (0 to 1) of std_logic_vector(255 downto 0);
    signal pins : boards;
begin
    clocks(0) <= not clocks(0) after HALF;
    process begin
        wait for offset * 1 ns;                      -- the secondary has its own oscillator
        loop
            clocks(1) <= not clocks(1);
            wait for HALF;
        end loop;
    end process;

    first : entity primary.board generic map (primary_taps) port map (clocks(0), serial, '0', reset, pins(0));
    second : entity secondary.board generic map (secondary_taps) port map (clocks(1), serial, reset, open, pins(1));

    process
        type characters is file of character;
        file source : characters open read_mode is bytes;
        variable letter : character;
        variable value : integer;
    begin
        wait for 100 us;
        while not endfile(source) loop
            read(source, letter);
            value := character'pos(letter);
            serial <= '0';
            wait for BIT_TIME;
            for place in 0 to 7 loop
                serial <= '1' when (value / 2 ** place) mod 2 = 1 else '0';
                wait for BIT_TIME;
            end loop;
            serial <= '1';
            wait for 2 * BIT_TIME;
        end loop;
        wait for 200 us;
        start <= now;
        recorded <= true;
        wait for 105 us;
        std.env.finish;
    end process;

    record_boards : for board in 0 to 1 generate
        process (pins(board), recorded)
            variable row : line;
        begin
            if recorded then
                write(row, board);
                write(row, ' ');
                write(row, (now - start) / 1 ps);
                write(row, ' ');
                hwrite(row, pins(board));
                writeline(output, row);
            end if;
        end process;
    end generate;
end architecture;
